"use strict";
/* Drive gains of a model with their standard errors, beside the nominal ones and those of another model. */
const Gains = (() => {
  const {el, quantity, unit} = Dom;

  /* found, base: models as JSON; base: the model before, or null. */
  function part(found, base = null) {
    const both = base && base !== found && base.gains_fitted;
    const rows = Object.entries(found.drive_gains).map(([joint, gain]) => [
      joint,
      ...(both ? [quantity(base.drive_gains[joint])] : []),
      quantity(gain),
      unit(gain.unit),
      ...(found.gains_fitted ? [ChartBasics.formatNumber(gain.nominal, 5), change(gain)] : []),
    ]);
    const columns = [
      ["motor", ""],
      ...(both ? [["before", "right"]] : []),
      [both ? "now ± standard error" : found.gains_fitted ? "gain ± standard error" : "gain", "right"],
      ["unit", "keep"],
      ...(found.gains_fitted
        ? [
            ["nominal", "right"],
            ["from nominal", "right"],
          ]
        : []),
    ];
    const title = found.gains_fitted ? "Drive gains" : "Drive gains, nominal";
    return el(
      "div",
      {class: "part gains"},
      el("h4", {}, title),
      Dom.table(
        columns.map(([name]) => name),
        rows,
        columns.map(([, kind]) => kind),
      ),
      found.notes.length
        ? el("ul", {class: "notes"}, ...found.notes.map((text) => el("li", {}, ...Dom.sentence(text))))
        : null,
    );
  }

  function change(gain) {
    if (!Dom.determined(gain)) return "–";
    const share = gain.value / gain.nominal - 1;
    return `${share > 0 ? "+" : ""}${ChartBasics.formatDigits(100 * share, 3)} %`;
  }

  return {part};
})();
