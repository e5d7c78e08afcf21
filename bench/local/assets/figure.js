"use strict";
/* A report's figure with its choices, drawn from data that the server gives. */
const Figures = (() => {
  const {el, select} = Dom;

  /* remembered: choices by name, kept by the caller; chose: called after each one. */
  function show(holder, figure, remembered = {}, chose = () => undefined) {
    const optionsOf = (choice) => [
      ...choice.options.map((option, k) => [String(k), option]),
      ...(choice.together ? [[ChartSeveral.ALL, choice.together]] : []),
    ];
    const numberOf = (choice, text) => optionsOf(choice).find(([, option]) => option === text)?.[0];
    const chosen = figure.choices.map((choice) => numberOf(choice, remembered[choice.name]) ?? String(choice.first));
    const screen = el("div", {class: "screen"});
    let charts = [];
    const draw = () => {
      charts.forEach((chart) => chart.destroy());
      charts = fill(screen, ChartSeveral.variant(figure, chosen));
    };
    const set = (i, value) => {
      chosen[i] = value;
      remembered[figure.choices[i].name] = optionsOf(figure.choices[i]).find(([number]) => number === value)[1];
    };
    const fields = figure.choices.map((choice, i) =>
      select(optionsOf(choice), chosen[i], (value) => {
        set(i, value);
        draw();
        chose();
      }),
    );
    holder.replaceChildren(
      el("h3", {}, figure.title),
      el("p", {class: "aid"}, figure.aid),
      el("div", {class: "row"}, ...figure.choices.map((choice, i) => Dom.field(choice.name, fields[i]))),
      screen,
    );
    draw();
    /* Show other options and go there; wanted: by a choice's name, whether an option is meant. */
    const go = (wanted) => {
      figure.choices.forEach((choice, i) => {
        const number = choice.options.findIndex(wanted[choice.name]);
        if (number < 0) return;
        set(i, String(number));
        fields[i].value = String(number);
      });
      draw();
      chose();
      holder.scrollIntoView();
    };
    return {go};
  }

  /* Notes and charts of a variant; the charts come back. */
  function fill(screen, variant) {
    const frames = variant.charts.map(() => el("div", {class: "chart"}));
    const titled = variant.charts.map(({title, aid}, i) =>
      el("div", {}, title ? el("h4", {}, title) : null, aid ? el("p", {class: "aid"}, aid) : null, frames[i]),
    );
    const legend = el("div");
    screen.replaceChildren(
      el("ul", {class: "notes"}, ...variant.notes.map((note) => el("li", {}, note))),
      legend,
      el("div", {class: variant.several ? "charts several" : "charts"}, ...titled),
    );
    if (variant.several && variant.charts.length) Charts.legend({...variant.charts[0].spec, legend: true}, legend);
    const charts = variant.charts.map((chart, i) => Charts.create(frames[i], chart.spec));
    if (variant.several) ChartSeveral.link(charts);
    return charts;
  }

  return {show};
})();
