"use strict";
/* What the workbench's section is made of: headings, tiles, buttons, and places for lists, tables and charts. */
const WorkbenchSkeleton = (() => {
  const {make} = WorkbenchList;

  function segments(parent, name, options, changed) {
    const set = make("fieldset", "", parent);
    make("legend", "", set, name);
    const select = make("select", "", set);
    select.setAttribute("aria-label", name);
    options.forEach((option, i) => (make("option", "", select, option).value = i));
    select.addEventListener("change", () => changed(Number(select.value)));
    return select;
  }

  function tile(list, name) {
    const one = make("div", "tile", list);
    make("dt", "", one, name);
    return {value: make("dd", "", one), note: make("dd", "note", one)};
  }

  function skeleton(section, data) {
    section.classList.add("bench");
    make("h2", "", section, "Workbench");
    make(
      "p",
      "lead",
      section,
      "Tick an effect, and this page fits the model anew. What it shows is what bench identify finds with these effects.",
    );
    const now = make("div", "bench-now", section);
    const tiles = make("dl", "tiles", now);
    const judged = tile(tiles, "Error, not fitted");
    const fitted = tile(tiles, "Error, fitted");
    const buttons = make("div", "bench-buttons", now);
    const found = make("button", "", buttons, "Found by diagnose");
    const nothing = make("button", "", buttons, "Nothing");
    for (const one of [found, nothing]) one.type = "button";
    const said = make("p", "bench-said", section);
    said.setAttribute("role", "status");
    const grid = make("div", "bench-grid", section);
    const left = make("div", "bench-list", grid);
    make("h3", "", left, "Effects");
    const then = "Beside each: the error on recordings that were not fitted, if you tick it or take it out";
    const kept = data.basis ? ", with the shapes of the others as they are" : ""; // of many effects
    make("p", "aid", left, `${then}${kept}.`);
    const list = make("ul", "bench-effects", left);
    const hidden = make("p", "aid", left);
    const right = make("div", "bench-answer", grid);
    const part = (title, aid) => {
      const one = make("div", "part", right);
      make("h3", "", one, title);
      if (aid) make("p", "aid", one, aid);
      return one;
    };
    const steps = `From the model without any effect; at each step the one that helps most${kept}.`;
    const judge = data.whole ? ` Judged on ${data.judged_on.replace(/, not fitted$/, "")}; fitted to the rest.` : "";
    const ladder = part("Error, effect by effect", steps + judge);
    const plainly = "Fitted, not fitted: error of this motor's current.";
    const motors = part(
      "Drive gains and errors",
      data.whole ? `${plainly} Gains and fitted error: a fit to all rows. Not fitted: judged as the ladder.` : plainly,
    );
    const curves = part("Currents", "");
    const choices = make("div", "choices", curves);
    const aid = make("p", "aid", curves);
    const more = make("div", "part", right);
    const fold = (title) => {
      const details = make("details", "", more);
      make("summary", "", details, title);
      return details;
    };
    return {
      judged,
      fitted,
      found,
      nothing,
      said,
      list,
      hidden,
      ladder: make("div", "chart", ladder),
      gains: make("div", "scroll", motors),
      choices,
      aid,
      curves: make("div", "chart", curves),
      parameters: make("div", "scroll", fold("Dynamic parameters")),
      command: make("pre", "", fold("The same on the command line")),
      data,
    };
  }

  function table(holder, heads, rows) {
    const found = document.createElement("table");
    const top = make("tr", "", make("thead", "", found));
    heads.forEach((head, i) => (make("th", i ? "right" : "", top, head).scope = "col"));
    const body = make("tbody", "", found);
    for (const row of rows) {
      const line = make("tr", "", body);
      row.forEach((cell, i) => {
        const at = make("td", i ? "right" : "", line, cell.text ?? cell);
        if (cell.data) Object.assign(at.dataset, cell.data);
      });
    }
    holder.replaceChildren(found);
  }

  return {segments, skeleton, table};
})();
