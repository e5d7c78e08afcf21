"use strict";
/* The models that the page fits, each once, by what is ticked. */
const WorkbenchModels = (() => {
  function remembering(data) {
    const {fit, places} = WorkbenchFit.create(data);
    const known = new Map();

    function fitted(ticks) {
      const name = JSON.stringify([...ticks].sort());
      if (!known.has(name)) known.set(name, fit(ticks));
      return known.get(name);
    }

    return {places, fit: fitted};
  }

  /*
  Where no recording is kept to judge on, one model is fitted to all rows, as bench identify does it, and one beside it
  (`beside`) to the first part of every recording: that one alone tells the error of what was not fitted.
  */
  function create(data) {
    const judging = remembering(data);
    if (!data.whole) return {...judging, judging, ofJudging: (fit) => fit};
    const whole = remembering(data.whole);
    const both = (fit, beside) => ({
      ...fit,
      beside,
      judged: beside.judged,
      by: fit.by.map((one, j) => ({...one, judged: beside.by[j].judged})),
    });
    return {
      places: whole.places,
      fit: (ticks) => both(whole.fit(ticks), judging.fit(ticks)),
      judging,
      ofJudging: (fit) => fit.beside,
    };
  }

  return {create};
})();
