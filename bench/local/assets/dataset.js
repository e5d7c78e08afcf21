"use strict";
/* The dataset that is shown, and its recordings. */
const Dataset = (() => {
  const {el, field, select} = Dom;

  /* Which dataset of the folder is shown. */
  function choice(app) {
    const known = app.folder.datasets;
    if (!known.length) return el("p", {class: "aid"}, "No dataset in this folder yet: drop the first log.");
    const options = known.map((path) => [path, path === "." ? app.folder.name : path]);
    return el(
      "div",
      {class: "row"},
      field(
        "Dataset",
        select(options, app.dataset, (value) => app.choose(value), {id: "dataset"}),
      ),
      el("a", {href: `zip/${Server.address(app.dataset)}`, download: true}, "Download this dataset"),
    );
  }

  /* Its recordings. */
  function table(app) {
    if (app.fault) return el("p", {class: "fault"}, app.fault);
    if (!app.described) return el("div");
    const data = app.described;
    const rows = data.recordings.map((recording) => [
      recording.name,
      recording.use === "identify" ? "fitted" : "only compared",
      load(app, recording.payload),
      `${ChartBasics.formatNumber(recording.seconds, 3)} s`,
      `${ChartBasics.formatNumber(recording.rate, 4)} Hz`,
      checked(recording),
    ]);
    const weighed =
      data.recordings.some(
        (recording) => recording.use === "identify" && recording.payload && data.payloads[recording.payload],
      ) && data.recordings.some((recording) => recording.use === "identify" && !recording.payload);
    const advice = weighed
      ? null
      : el(
          "p",
          {class: "aid"},
          "For drive gains, one recording without a payload and one with a payload that was weighed are needed; until then gains stay nominal.",
        );
    return el(
      "div",
      {},
      Dom.table(
        ["recording", "use", "payload", "length", "rate", "checks"],
        rows,
        ["", "", "", "right", "right", data.recordings.some((recording) => recording.asked) ? "words" : "keep"],
        "stacked",
      ),
      advice,
    );
  }

  /* What the checks say of a recording; what is still asked of it comes first. */
  function checked(recording) {
    if (recording.asked) return el("span", {class: "poor"}, `! ${recording.asked} Import its log again to correct it.`);
    return recording.accepted.length ? `✓ passed; accepted: ${recording.accepted.join(", ")}` : "✓ all checks passed";
  }

  function load(app, name) {
    if (!name) return "none";
    const mass = app.described.payloads[name];
    return mass === null || mass === undefined ? name : `${name}, ${mass} kg`;
  }

  return {choice, table};
})();
