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
    const box = make("div", "tile", list);
    make("dt", "", box, name);
    return {value: make("dd", "", box), note: make("dd", "note", box)};
  }

  function skeleton(section) {
    section.classList.add("bench");
    make("h2", "", section, "Workbench");
    make(
      "p",
      "lead",
      section,
      "Tick an effect, and this page fits gains and all that enters linearly anew, at once. Shapes, such as a speed or a period, stay as diagnose found them; the command below fits them anew, too.",
    );
    const now = make("div", "bench-now", section);
    const tiles = make("dl", "tiles", now);
    const judged = tile(tiles, "Error, not fitted");
    const fitted = tile(tiles, "Error, fitted");
    const buttons = make("div", "bench-buttons", now);
    const pin = make("button", "", buttons, "Keep as A");
    const found = make("button", "", buttons, "Found by diagnose");
    const nothing = make("button", "", buttons, "Nothing");
    for (const button of [found, nothing, pin]) button.type = "button";
    pin.title = "Keep this model, to see another one beside it";
    const pinned = make("p", "bench-pinned", section);
    const said = make("p", "bench-said", section);
    said.setAttribute("role", "status");
    const grid = make("div", "bench-grid", section);
    const left = make("div", "bench-list", grid);
    make("h3", "", left, "Effects");
    const then = "Beside each: the error on recordings that were not fitted, if you tick it or take it out";
    make("p", "aid", left, `${then}.`);
    const list = make("ul", "bench-effects", left);
    const hidden = make("p", "aid", left);
    const right = make("div", "bench-answer", grid);
    const part = (title, aid) => {
      const box = make("div", "part", right);
      make("h3", "", box, title);
      if (aid) make("p", "aid", box, aid);
      return box;
    };
    const ladder = part(
      "Error, effect by effect",
      "From the model without any effect; at each step the one that helps most.",
    );
    const motors = part(
      "Drive gains and errors",
      "Standard error: of the gain, known of the models that diagnose fitted; bench identify tells it of others. Fitted, not fitted: error of this motor's current.",
    );
    const curves = part("Currents", "");
    const choices = make("div", "choices", curves);
    const aid = make("p", "aid", curves);
    const line = part("The same on the command line", "With its shapes fitted anew, and all standard errors.");
    const holder = make("div", "bench-command", line);
    const shown = make("pre", "", holder);
    shown.tabIndex = 0;
    const copy = make("button", "", holder, "Copy");
    copy.type = "button";
    copy.setAttribute("aria-label", "Copy the command");
    const model = make("p", "bench-model", line);
    const download = make("button", "", model, "Download model");
    download.type = "button";
    const file = make("span", "aid", model);
    const details = make("details", "", make("div", "part", right));
    make("summary", "", details, "Dynamic parameters");
    return {
      judged,
      fitted,
      found,
      nothing,
      pin,
      pinned,
      said,
      list,
      hidden,
      ladder: make("div", "chart", ladder),
      gains: make("div", "scroll", motors),
      choices,
      aid,
      curves: make("div", "chart", curves),
      parameters: make("div", "scroll", details),
      command: shown,
      copy,
      download,
      file,
    };
  }

  /* The command with these effects; line: as far as it does not depend on them. A word is as a shell takes it. */
  function command(line, requests) {
    const quoted = (word) => (/^[\w\-./:=,+~]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);
    return [line, ...requests.map((request) => `--with ${quoted(request)}`)].join(" \\\n  ");
  }

  async function copied(text, button) {
    try {
      await navigator.clipboard.writeText(text.textContent);
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(text); // a browser may not let a page write there
      button.textContent = "Selected";
    }
    setTimeout(() => (button.textContent = "Copy"), 2000);
  }

  /* Hand the reader a file. */
  function saved(content, name) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([`${JSON.stringify(content, null, 1)}\n`], {type: "application/json"}));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
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

  return {segments, skeleton, table, command, copied, saved};
})();
