"use strict";
/* A report's figure with its choices, drawn from data that the server gives. */
const Figures = (() => {
  const {el, select} = Dom;

  function show(holder, figure, remembered = {}, chose = () => undefined) {
    const chosen = figure.choices.map((choice) => {
      const before = choice.options.indexOf(remembered[choice.name]);
      return before < 0 ? choice.first : before;
    });
    const screen = el("div", {class: "screen"});
    let charts = [];
    const draw = () => {
      charts.forEach((chart) => chart.destroy());
      const variant = figure.variants[chosen.join("|")];
      const notes = el("ul", {class: "notes"}, ...variant.notes.map((note) => el("li", {}, note)));
      const frames = variant.charts.map(() => el("div", {class: "chart"}));
      screen.replaceChildren(notes, el("div", {class: "charts"}, ...frames));
      charts = variant.charts.map((chart, i) => Charts.create(frames[i], chart.spec));
    };
    const choices = figure.choices.map((choice, i) =>
      Dom.field(
        choice.name,
        select(
          choice.options.map((option, k) => [String(k), option]),
          String(chosen[i]),
          (value) => {
            chosen[i] = Number(value);
            remembered[choice.name] = choice.options[chosen[i]];
            draw();
            chose();
          },
        ),
      ),
    );
    holder.replaceChildren(
      el("h3", {}, figure.title),
      el("p", {class: "aid"}, figure.aid),
      el("div", {class: "row"}, ...choices),
      screen,
    );
    draw();
    return {destroy: () => charts.forEach((chart) => chart.destroy())};
  }

  return {show};
})();
