"use strict";
/*
Charts: small figures in SVG, drawn from plain data; colours come from the style sheet, so that they follow the theme.

  const chart = Charts.create(element, figure);   // element: an empty block; it decides the width
  chart.update({panels: [...]});                  // keys that are given replace those of the figure
  chart.draw(width);                              // again, at a width of one's own (print)
  chart.point(x); chart.unpoint();                // the cursor at a value of x, and away
  chart.destroy();
  Charts.legend(figure, element);                 // a legend apart from its chart

A figure is {label, height, x: axis, panels: [{weight, y: axis, series: [...]}], legend: true}; panels stand below each
other and share x. An axis is {label, scale: "linear" | "log" | "band", domain: [low, high], include: [values],
categories: [text], percent: true, turned: true}; all but the label may be left out. `turned` names stand upright;
`caption` is a line above the panels, which the values at the cursor replace; without it, they are in a box at the cursor;
a figure with `least` is never narrower, in px, and scrolls where there is less room.

Values are arrays, in which null is a gap; an x of even steps may be {start, step}. Every series has `kind`, `role` (its
colour: measured, modelled, error, before, after, noise, forwards, backwards, one ... seven), and `name` for the legend.
  line       x, y; dashed, marker, faint: true; texts beside its points
  envelope   x, low, high: the smallest and the largest value of stretches of samples
  band       low, high: numbers, or arrays with x
  bins       x, mean, spread, low, high: means with markers, ± spread as a band, whiskers to the extreme values, clear: true for whiskers that count,
             apart: true for means that are not joined
  points     x, y
  stems      x, y
  histogram  edges, y; curve beside it: a line
  bars       y: vertical bars over a band of categories; several series stand side by side
  hbars      x: horizontal bars over a band of categories on y; thin: true for a mark inside
  intervals  y: numbers of categories, x, low, high: points with whiskers over a band on y; shift
  cells      x, y: numbers of categories, share: 0 to 1, texts: a matrix over two bands
cells and bins with `pick`, an object for each, can be clicked: a "pick" event with it goes up through the page.
  rule       at, axis: "x" | "y"; a straight line across
*/
const Charts = (() => {
  const {CHARACTER, node, block, formatNumber, formatPercent, known} = ChartBasics;
  const {DRAW, dot, rectangle} = ChartSeries;
  let number = 0;

  function widen(range, values) {
    if (typeof values === "number") values = [values];
    if (!values || values.length === undefined) return;
    for (let i = 0; i < values.length; i++) {
      const value = values[i];
      if (!known(value)) continue;
      if (value < range[0]) range[0] = value;
      if (value > range[1]) range[1] = value;
      if (value > 0 && value < range[2]) range[2] = value;
    }
  }

  /* Smallest, largest and smallest positive value of an axis over its series. */
  function extent(axis, series, which) {
    const range = [Infinity, -Infinity, Infinity];
    for (const entry of series) {
      if (which === "x") {
        const count = (entry.y || entry.mean || entry.low || []).length;
        if (entry.x && entry.x.step !== undefined)
          widen(range, [entry.x.start, entry.x.start + entry.x.step * (count - 1)]);
        else widen(range, entry.x);
        widen(range, entry.edges);
        if (entry.kind === "hbars") widen(range, [0]);
        if (entry.kind === "intervals") [entry.low, entry.high].forEach((ends) => widen(range, ends));
        if (entry.kind === "rule" && entry.axis === "x") widen(range, entry.at);
      } else {
        if (entry.kind !== "intervals")
          [entry.y, entry.low, entry.high, entry.mean].forEach((values) => widen(range, values));
        if (entry.spread)
          widen(
            range,
            entry.mean.map((m, i) => (known(m) ? m - entry.spread[i] : null)),
          );
        if (entry.spread)
          widen(
            range,
            entry.mean.map((m, i) => (known(m) ? m + entry.spread[i] : null)),
          );
        if (["bars", "stems", "histogram"].includes(entry.kind)) widen(range, [0]);
        if (entry.kind === "rule" && entry.axis !== "x") widen(range, entry.at);
      }
    }
    if (axis.include) widen(range, axis.include);
    return range;
  }

  function steps(low, high, wanted) {
    const rough = (high - low) / Math.max(wanted, 1);
    const power = 10 ** Math.floor(Math.log10(rough));
    return power * [1, 2, 5, 10].find((digit) => digit * power >= rough * 0.999);
  }

  /* A scale: at(value) in px, ticks, label of a tick. */
  function scaleOf(axis, series, which, from, to, wanted) {
    if (axis.scale === "band") {
      const count = Math.max(axis.categories.length, 1);
      const width = (to - from) / count;
      return {
        band: true,
        turned: axis.turned,
        width,
        at: (i) => from + (i + 0.5) * width,
        ticks: axis.categories.map((_, i) => i),
        text: (i) => axis.categories[i],
      };
    }
    const range = extent(axis, series, which);
    let [low, high] = axis.domain || range;
    if (!known(low) || !known(high)) [low, high] = [0, 1];
    const factor = axis.percent ? 100 : 1;
    if (axis.scale === "log") {
      low = low > 0 ? low : known(range[2]) ? range[2] : high / 1000 || 1;
      high = Math.max(high, low * 1.001);
      if (!axis.domain) [low, high] = [low / 1.25, high * (axis.room ? 2 : 1.25)];
      const [a, b] = [Math.log10(low), Math.log10(high)];
      const every = b - a > 2.2 * wanted ? 2 : 1;
      const inner = b - a > 3 ? [1] : b - a > 1.4 ? [1, 3] : [1, 2, 5];
      let ticks = [];
      for (let e = Math.floor(a); e <= Math.ceil(b); e += every) for (const m of inner) ticks.push(m * 10 ** e);
      ticks = ticks.filter((t) => t >= low * 0.999 && t <= high * 1.001);
      if (ticks.length < 2) ticks = [low, high].map((v) => Number(v.toPrecision(2)));
      const at = (v) => from + ((Math.log10(Math.max(v, 1e-300)) - a) / (b - a)) * (to - from);
      return {low, high, at, ticks, text: (t) => formatNumber(t * factor, 3)};
    }
    if (high === low) [low, high] = [low - (Math.abs(low) || 1) / 2, high + (Math.abs(high) || 1) / 2];
    const room = axis.domain || (which === "x" && !axis.room) ? 0 : 0.06 * (high - low);
    if (low !== 0 || !axis.include) low -= room;
    high += room;
    const ticksOf = (step) => {
      const first = Math.ceil(low / step - 1e-9);
      return Array.from({length: Math.floor(high / step + 1e-9) - first + 1}, (_, i) => (first + i) * step);
    };
    let step = steps(low, high, wanted);
    if (ticksOf(step).length < 3) step = steps(low, high, 2 * wanted); // one number alone tells no size
    const ticks = ticksOf(step);
    const digits = Math.max(1, Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / step)) + 1);
    const at = (v) => from + ((v - low) / (high - low)) * (to - from);
    return {low, high, at, ticks, text: (t) => formatNumber(Math.abs(t) < step / 1e6 ? 0 : t * factor, digits)};
  }

  const FLAT = ["band", "envelope", "bars", "hbars", "histogram"]; // shown in a legend as a patch, others as a line

  function legendOf(figure, parent) {
    const seen = new Map();
    for (const panel of figure.panels)
      for (const entry of panel.series) if (entry.name && !seen.has(entry.name)) seen.set(entry.name, entry);
    if (figure.legend === false || seen.size < 1) return;
    const list = block("ul", "legend", parent);
    for (const [name, entry] of seen) {
      const item = block("li", "", list);
      const mark = node("svg", {viewBox: "0 0 22 12", width: 22, height: 12, "aria-hidden": "true"}, item);
      const soft = entry.kind === "band" || entry.thin;
      if (FLAT.includes(entry.kind))
        node("rect", {x: 1, y: 1, width: 20, height: 10, class: `${soft ? "band" : "fill"} ${entry.role}`}, mark);
      else if (entry.kind !== "intervals" && entry.kind !== "points")
        node(
          "path",
          {d: "M1 6H21", class: `line ${entry.role}${entry.dashed ? " dashed" : ""}${entry.faint ? " faint" : ""}`},
          mark,
        );
      if (entry.marker || ["bins", "points", "intervals", "stems"].includes(entry.kind))
        dot(11, 6, entry.role, mark, 3.4);
      item.appendChild(document.createTextNode(name));
    }
    if (figure.panels.length > 1 && ChartZoom.possible(figure))
      block("li", "hint", list, "drag across the curves to enlarge them");
  }

  function shortened(text, room) {
    const most = Math.max(4, Math.floor(room / CHARACTER));
    return text.length > most ? `${text.slice(0, most - 1)}…` : text;
  }

  /* A text in lines of so many px, each at least a word. */
  function wrapped(text, room) {
    const lines = [];
    for (const word of text.split(" ")) {
      const last = lines.length - 1;
      if (last >= 0 && (lines[last].length + 1 + word.length) * CHARACTER <= room) lines[last] += ` ${word}`;
      else lines.push(word);
    }
    return lines.map((line) => shortened(line, room));
  }

  /* Ticks that leave each other room along x; of a band all, in several lines where they are long. */
  function xTicks(scale, left, right, top, bottom, svg) {
    let last = -Infinity;
    for (const tick of scale.ticks) {
      const at = scale.at(tick);
      const whole = scale.text(tick);
      if (scale.band && scale.turned) {
        const place = `translate(${(at + 4).toFixed(1)} ${bottom + 8}) rotate(-90)`;
        node("text", {transform: place, class: "tick", "text-anchor": "end"}, svg, whole);
        continue;
      }
      if (scale.band) {
        const mark = node("text", {y: bottom + 15, class: "tick", "text-anchor": "middle"}, svg);
        wrapped(whole, scale.width - 8).forEach((text, i) =>
          node("tspan", {x: at.toFixed(1), dy: i ? 14 : 0}, mark, text),
        );
        continue;
      }
      const text = whole;
      const half = (text.length * CHARACTER) / 2;
      node("path", {d: `M${at.toFixed(1)} ${top}V${bottom}`, class: "grid"}, svg);
      if (at - half < last + 6) continue;
      last = at + half;
      node(
        "text",
        {x: Math.min(at, right - half + 10).toFixed(1), y: bottom + 15, class: "tick", "text-anchor": "middle"},
        svg,
        text,
      );
    }
  }

  function yTicks(scale, left, right, svg) {
    for (const tick of scale.ticks) {
      const y = scale.at(tick);
      const whole = scale.text(tick);
      const text = scale.band ? shortened(whole, left - 8) : whole;
      if (!scale.band) node("path", {d: `M${left} ${y.toFixed(1)}H${right}`, class: "grid"}, svg);
      const mark = node("text", {x: left - 7, y: (y + 4).toFixed(1), class: "tick", "text-anchor": "end"}, svg, text);
      if (text !== whole) node("title", {}, mark, whole);
    }
  }

  function draw(chart, width) {
    const figure = ChartZoom.shown(chart);
    chart.element.replaceChildren();
    legendOf(figure, chart.element);
    const caption = figure.caption ? block("p", "aid caption", chart.element, figure.caption) : null;
    const total = figure.height || 240;
    const wider = width > chart.width + 1;
    const holder = block("div", wider ? "plot wider" : "plot", chart.element);
    if (wider) holder.tabIndex = 0; // so that keys can scroll it
    const svg = node(
      "svg",
      {
        viewBox: `0 0 ${width} ${total}`,
        width,
        height: total,
        role: picked(figure) ? "group" : "img",
        "aria-label": figure.label || "",
      },
      holder,
    );
    const count = figure.panels.length;
    const weights = figure.panels.map((panel) => panel.weight || 1);
    const sum = weights.reduce((a, b) => a + b, 0);
    const head = count > 1 ? 26 : 20; // px, of the label above a panel
    const bands = figure.x.scale === "band" ? figure.x.categories : [];
    const lines = Math.max(1, ...bands.map((text) => wrapped(text, (width - 60) / bands.length - 8).length));
    const under = figure.x.turned ? Math.max(...bands.map((text) => text.length)) * CHARACTER : 14 * (lines - 1);
    const words = figure.x.label ? wrapped(figure.x.label, width - 8) : [];
    const foot = 22 + under + (words.length ? 16 + 14 * (words.length - 1) : 0);
    const room = total - foot - head * count;
    const all = figure.panels.flatMap((panel) => panel.series);
    let top = 0;
    const boxes = weights.map((weight) => {
      const box = {top: top + head, bottom: top + head + (room * weight) / sum};
      top = box.bottom;
      return box;
    });
    const scales = figure.panels.map((panel, i) => {
      const {top: high, bottom: low} = boxes[i];
      const down = panel.y.scale === "band" ? [high, low] : [low, high];
      return scaleOf(panel.y, panel.series, "y", down[0], down[1], Math.max(3, Math.floor((low - high) / 32)));
    });
    const wide = scales.map((scale) => Math.max(...scale.ticks.map((t) => scale.text(t).length), 1) * CHARACTER + 12);
    const left = Math.min(Math.max(...wide, 34), 0.42 * width);
    const right = width - 12;
    const xs = scaleOf(figure.x, all, "x", left, right, Math.max(3, Math.floor((right - left) / 64)));
    const bottom = boxes[count - 1].bottom;
    figure.panels.forEach((panel, i) => {
      const box = {...boxes[i], left, right};
      const group = node("g", {}, svg);
      if (i === count - 1) xTicks(xs, left, right, box.top, box.bottom, group);
      else if (!xs.band)
        for (const t of xs.ticks)
          node("path", {d: `M${xs.at(t).toFixed(1)} ${box.top}V${box.bottom}`, class: "grid"}, group);
      yTicks(scales[i], left, right, group);
      if (panel.y.label)
        node("text", {x: Math.max(0, Math.min(left - 34, 6)), y: box.top - 7, class: "label"}, group, panel.y.label);
      const clip = `clip-${(number += 1)}`;
      const shape = node("clipPath", {id: clip}, svg);
      rectangle(left - 4, right + 4, box.top - 1, box.bottom + 1, "", shape); // dots at the ends stay whole
      const plot = node("g", {"clip-path": `url(#${clip})`}, svg);
      box.above = node("g", {}, svg); // texts are not cut
      const bars = panel.series.filter((entry) => entry.kind === "bars");
      for (const entry of panel.series)
        DRAW[entry.kind](entry, xs, scales[i], plot, box, {index: bars.indexOf(entry), count: bars.length});
      const axis = scales[i].band || !(scales[i].low < 0 && scales[i].high > 0) ? box.bottom : scales[i].at(0);
      node("path", {d: `M${left} ${axis.toFixed(1)}H${right}`, class: "axis"}, svg);
    });
    words.forEach((text, i) => {
      const half = (text.length * CHARACTER) / 2;
      const place = {
        x: Math.max(half, Math.min((left + right) / 2, width - half)),
        y: total - 6 - 14 * (words.length - 1 - i),
      };
      node("text", {...place, class: "label", "text-anchor": "middle"}, svg, text);
    });
    const box = {xs, left, right, top: boxes[0].top, bottom, width};
    if (!xs.band) ChartCursor.watch(chart, svg, holder, box, caption);
    if (ChartZoom.possible(figure)) ChartZoom.watch(chart, svg, holder, box);
  }

  /* Whether parts of a figure can be picked: their readers must find them inside it. */
  function picked(figure) {
    return figure.panels.some((panel) => panel.series.some((entry) => entry.pick));
  }

  function create(element, figure) {
    const nothing = () => undefined; // to be pointed at, until the chart is drawn
    const chart = {element, figure, width: 0, stretch: null, point: nothing, unpoint: nothing};
    chart.draw = (width) => {
      const room = width || element.clientWidth;
      if (room < 40) return;
      chart.width = room;
      draw(chart, Math.round(width ? room : Math.max(room, chart.figure.least || 0)));
    };
    chart.update = (changes) => {
      if (changes.label !== chart.figure.label) chart.stretch = null; // other curves
      chart.figure = {...chart.figure, ...changes};
      chart.draw();
    };
    const observer = new ResizeObserver(() => {
      if (Math.abs(element.clientWidth - chart.width) > 1) chart.draw();
    });
    chart.destroy = () => {
      observer.disconnect();
      element.replaceChildren();
    };
    chart.draw();
    observer.observe(element);
    return chart;
  }

  return {create, legend: legendOf, formatNumber, formatPercent};
})();
