"use strict";
/* A report's figure with its choices, drawn from data that the server gives; all motors can be seen side by side. */
const Figures = (() => {
  const {el, select} = Dom;
  const MOTOR = "Motor"; // the choice of which all options can be seen at once
  const ALL = "all";
  const LOWER = 0.75; // of its height, of a chart among several

  /* remembered: choices by name, kept by the caller; chose: called after each one. go: shows other choices by name. */
  function show(holder, figure, remembered = {}, chose = () => undefined) {
    const optionsOf = (choice) => [
      ...choice.options.map((option, k) => [String(k), option]),
      ...(choice.name === MOTOR && choice.options.length > 1 ? [[ALL, "all side by side"]] : []),
    ];
    const numberOf = (choice, text) => optionsOf(choice).find(([, option]) => option === text)?.[0];
    const chosen = figure.choices.map((choice) => numberOf(choice, remembered[choice.name]) ?? String(choice.first));
    const screen = el("div", {class: "screen"});
    let charts = [];
    const draw = () => {
      charts.forEach((chart) => chart.destroy());
      const every = chosen.indexOf(ALL);
      charts = every < 0 ? one(screen, figure.variants[chosen.join("|")]) : all(screen, figure, chosen, every);
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
    /* wanted: for a choice's name, whether an option is meant. */
    const go = (wanted) => {
      figure.choices.forEach((choice, i) => {
        const number = choice.options.findIndex(wanted[choice.name]);
        if (number < 0) return;
        set(i, String(number));
        fields[i].value = String(number);
      });
      draw();
      chose();
      holder.scrollIntoView({block: "start"});
    };
    return {go};
  }

  const notesOf = (variant) => el("ul", {class: "notes"}, ...variant.notes.map((note) => el("li", {}, note)));

  function one(screen, variant) {
    const frames = variant.charts.map(() => el("div", {class: "chart"}));
    screen.replaceChildren(notesOf(variant), el("div", {class: "charts"}, ...frames));
    return variant.charts.map((chart, i) => Charts.create(frames[i], chart.spec));
  }

  /* The charts of every option of a choice, over one time axis, with one cursor. */
  function all(screen, figure, chosen, every) {
    const variants = figure.choices[every].options.map(
      (_, k) => figure.variants[chosen.map((number, i) => (i === every ? String(k) : number)).join("|")],
    );
    const drawn = variants.flatMap((variant) => variant.charts.map((chart) => chart.spec));
    if (!drawn.length) return one(screen, {charts: [], notes: variants.flatMap((variant) => variant.notes)});
    const specs = ChartCursor.together(drawn);
    const frames = specs.map(() => el("div", {class: "chart"}));
    let k = 0;
    const cells = variants.map((variant) => el("div", {}, notesOf(variant), ...variant.charts.map(() => frames[k++])));
    const legend = el("div");
    Charts.legend(specs[0], legend);
    screen.replaceChildren(legend, el("div", {class: "charts several"}, ...cells));
    const charts = specs.map((spec, i) =>
      Charts.create(frames[i], {...spec, legend: false, height: LOWER * spec.height}),
    );
    ChartCursor.link(charts);
    return charts;
  }

  return {show};
})();
