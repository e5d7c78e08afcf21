"use strict";
/* Charts of all options of a choice side by side: over one axis, with one cursor and one stretch of it. */
const ChartSeveral = (() => {
  const {valueAt} = ChartBasics;
  const ALL = "all"; // in the place of an option's number
  const LOWER = 0.75; // of its height, of a chart among several

  /* What a figure shows; chosen: the number of an option, or ALL, for each of its choices. */
  function variant(figure, chosen) {
    const every = chosen.indexOf(ALL);
    if (every < 0) return figure.variants[chosen.join("|")];
    const each = figure.choices[every].options.map((title, k) => {
      const found = figure.variants[chosen.map((number, i) => (i === every ? String(k) : number)).join("|")];
      return {title, ...found};
    });
    const drawn = each.flatMap(({title, charts}) => charts.map(({spec}) => ({title, spec})));
    const domain = extent(drawn.map(({spec}) => spec));
    const charts = drawn.map(({spec, ...words}) => ({
      ...words,
      spec: {
        ...spec,
        x: {...spec.x, domain},
        height: LOWER * spec.height,
        legend: false,
        shared: true,
        caption: spec.facts,
      },
    }));
    const notes = each.filter((option) => !option.charts.length).flatMap((option) => option.notes);
    return {notes, charts, several: true};
  }

  /* From the first x of any curve to the last. */
  function extent(specs) {
    const series = specs.flatMap((spec) => spec.panels.flatMap((panel) => panel.series));
    const lines = series.filter((entry) => entry.kind === "line" && entry.y.length);
    return [
      Math.min(...lines.map((entry) => valueAt(entry.x, 0))),
      Math.max(...lines.map((entry) => valueAt(entry.x, entry.y.length - 1))),
    ];
  }

  /* Where one chart is pointed at or enlarged, so are the others. */
  function link(charts) {
    for (const chart of charts) {
      const others = charts.filter((other) => other !== chart);
      chart.element.addEventListener("cursor", ({detail}) => others.forEach((other) => other.point(detail)));
      chart.element.addEventListener("uncursor", () => others.forEach((other) => other.unpoint()));
      chart.element.addEventListener("stretch", ({detail}) =>
        others.forEach((other) => {
          other.stretch = detail;
          other.draw();
        }),
      );
    }
  }

  return {ALL, variant, link};
})();
