"use strict";
/* Small pieces that the page is made of. Texts are only ever set as text: what a file is called is never markup. */
const Dom = (() => {
  const {el} = ChartBasics;
  const {table, command, unit} = Elements;

  /* A label with a name and its input. */
  function field(name, input) {
    return el("label", {}, el("span", {class: "name"}, name), input);
  }

  function select(options, chosen, changed, properties = {}) {
    const made = el("select", {...properties, change: () => changed(made.value)});
    for (const [value, text] of options) made.append(el("option", {value, selected: value === chosen}, text));
    return made;
  }

  function radios(legend, name, options, chosen, changed) {
    const made = el("fieldset", {}, el("legend", {}, legend));
    for (const [value, text] of options) {
      const input = el("input", {type: "radio", name, value, checked: value === chosen, change: () => changed(value)});
      made.append(el("label", {}, input, text));
    }
    return made;
  }

  /* What a command said: its fault, or what it printed, folded away. */
  function outcome(job) {
    if (!job) return el("div");
    if (job.state !== "done")
      return el("div", {}, el("p", {class: "fault", role: "alert"}, job.error || "It did not end well."));
    if (!job.output) return el("div");
    return el(
      "details",
      {class: "printed-text"},
      el("summary", {}, "What the command printed"),
      el("pre", {tabindex: "0"}, job.output),
    );
  }

  /* A small picture of a column. */
  function spark(values) {
    const svg = ChartBasics.node("svg", {
      class: "spark",
      viewBox: "0 0 88 26",
      preserveAspectRatio: "none",
      "aria-hidden": "true",
    });
    const known = values.filter((value) => value !== null);
    const [low, high] = [Math.min(...known), Math.max(...known)];
    const at = (value) => (high > low ? 24 - (22 * (value - low)) / (high - low) : 13);
    let path = "",
      open = false;
    values.forEach((value, i) => {
      if (value === null) open = false;
      else {
        path += `${open ? "L" : "M"}${((88 * i) / Math.max(values.length - 1, 1)).toFixed(1)} ${at(value).toFixed(1)}`;
        open = true;
      }
    });
    if (path) ChartBasics.node("path", {d: path, "vector-effect": "non-scaling-stroke"}, svg);
    return svg;
  }

  /* A sentence as a program says it: true minus signs, no line ends before a % or after a <, and what is to be typed, between backticks, set so. */
  function sentence(text) {
    const minus = text.replace(/(?<![\w.])-(?=\d)/g, "−").replace(/(?<=\d) (?=%)|(?<=[<>]) (?=\d)/g, "\u00a0");
    return minus.split("`").map((part, i) => (i % 2 ? el("code", {}, part) : part));
  }

  /* A step with nothing to show yet is one line: its heading, and what it waits for. */
  function later(body, waits, text = "") {
    body.closest("section").classList.toggle("later", waits);
    if (text) body.replaceChildren(el("p", {class: "aid"}, text));
  }

  const VAST = 1e6; // in SI units: no parameter of a robot is known as badly as that

  /* Whether the data say anything of a number, by the rule of Quantity.determined and DriveGain.determined. */
  function determined({value, std, nominal}) {
    if (std === null || (std >= VAST && std > Math.abs(value))) return false;
    return nominal === undefined || std <= Math.abs(value);
  }

  /* A number with its standard deviation, to the digits that it supports. */
  function quantity(found) {
    if (!determined(found)) return "not determined";
    if (!(found.std > 0)) return ChartBasics.formatNumber(found.value, 5);
    if (Math.max(Math.abs(found.value), found.std) >= VAST)
      return `${ChartBasics.formatNumber(found.value, 5)} ± ${ChartBasics.formatNumber(found.std, 2)}`;
    return `${ChartBasics.formatKnown(found.value, found.std)} ± ${ChartBasics.formatKnown(found.std, found.std)}`;
  }

  const percent = (share) => (share === null || share === undefined ? "–" : ChartBasics.formatPercent(share));

  return {
    el,
    field,
    select,
    radios,
    table,
    command,
    outcome,
    spark,
    sentence,
    later,
    determined,
    quantity,
    unit,
    percent,
  };
})();
