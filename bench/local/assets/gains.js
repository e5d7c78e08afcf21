"use strict";
/* Drive gains of a model with their standard errors, beside the nominal ones and those of another model. */
const Gains = (() => {
  const {el, quantity, unit} = Dom;

  /* found, base: models as JSON; base: the model before, or null. brief: a table for a narrow place, without these. */
  function part(found, base = null, brief = false) {
    const both = base && base !== found && base.gains_fitted && !brief;
    const units = new Set(Object.values(found.drive_gains).map((gain) => unit(gain.unit)));
    const shared = brief && units.size === 1 ? [...units][0] : null; // the unit of all, said once
    const sized = (gain) => (brief && shared === null ? `${quantity(gain)} ${unit(gain.unit)}` : quantity(gain));
    const rows = Object.entries(found.drive_gains).map(([joint, gain]) => [
      joint,
      ...(both ? [quantity(base.drive_gains[joint])] : []),
      sized(gain),
      ...(brief ? [] : [unit(gain.unit)]),
      ...(found.gains_fitted && !brief ? [ChartBasics.formatNumber(gain.nominal, 5)] : []),
      ...(found.gains_fitted ? [change(gain)] : []),
    ]);
    const error = brief ? "" : " ± standard error";
    const columns = [
      ["motor", ""],
      ...(both ? [["before", "right"]] : []),
      [both ? `now${error}` : found.gains_fitted ? `gain${error}` : "gain", "right"],
      ...(brief ? [] : [["unit", "keep"]]),
      ...(found.gains_fitted && !brief ? [["nominal", "right"]] : []),
      ...(found.gains_fitted ? [["from nominal", "right"]] : []),
    ];
    const kind = found.gains_fitted ? (brief ? " ± standard error" : "") : ", nominal";
    const title = `Drive gains${kind}${shared ? `, ${shared}` : ""}`;
    return el(
      "div",
      {class: "part gains"},
      el("h4", {}, title),
      Dom.table(
        columns.map(([name]) => name),
        rows,
        columns.map(([, alignment]) => alignment),
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
