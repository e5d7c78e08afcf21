"use strict";
/* The models that the page fits, each once: by what is ticked, and by the values at which shapes are held. */
const WorkbenchModels = (() => {
  const heldOf = (ticks, held) => Object.fromEntries(Object.entries(held).filter(([key]) => ticks.has(key)));
  const nameOf = (ticks, held) => JSON.stringify([[...ticks].sort(), Object.entries(heldOf(ticks, held)).sort()]);

  function remembering(data) {
    const equations = WorkbenchFit.create(data);
    const {places} = equations;
    const known = new Map();

    function fit(ticks, held) {
      const name = nameOf(ticks, held);
      if (!known.has(name)) known.set(name, equations.fit(ticks, heldOf(ticks, held)));
      return known.get(name);
    }

    /* The same in parts, with a pause after each. */
    function* fitted(ticks, held) {
      const name = nameOf(ticks, held);
      if (!known.has(name)) known.set(name, yield* equations.fitted(ticks, heldOf(ticks, held)));
      return known.get(name);
    }

    /* Nearly the same in an instant, from a model nearby; the same where no effect needs several rounds. */
    function nearly(ticks, held, near) {
      const curved = places.some((place) => place.curved && ticks.has(place.key));
      if (!curved || known.has(nameOf(ticks, held))) return fit(ticks, held);
      return equations.nearly(ticks, heldOf(ticks, held), near);
    }

    return {places, fit, fitted, nearly, has: (ticks, held) => known.has(nameOf(ticks, held))};
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
      fit: (ticks, held) => both(whole.fit(ticks, held), judging.fit(ticks, held)),
      *fitted(ticks, held) {
        const fit = yield* whole.fitted(ticks, held);
        yield;
        return both(fit, yield* judging.fitted(ticks, held));
      },
      nearly: (ticks, held, near) => both(whole.nearly(ticks, held, near), judging.nearly(ticks, held, near.beside)),
      has: (ticks, held) => whole.has(ticks, held) && judging.has(ticks, held),
      judging,
      ofJudging: (fit) => fit.beside,
    };
  }

  return {create};
})();
