"use strict";
/* Pieces that every page is made of. Texts are only ever set as text: what a file is called is never markup. */
const Elements = (() => {
  const {el} = ChartBasics;

  /* A table in a holder that scrolls; kinds: classes of its columns. holding: further classes of the holder. */
  function table(heads, rows, kinds = [], holding = "") {
    const head = el("tr", {}, ...heads.map((text, i) => el("th", {scope: "col", class: kinds[i] || null}, text)));
    const body = rows.map((cells) =>
      el("tr", {}, ...cells.map((cell, i) => el("td", {class: kinds[i] || null, "data-head": heads[i]}, cell))),
    );
    return el(
      "div",
      {class: `scroll ${holding}`.trim()},
      el("table", {}, el("thead", {}, head), el("tbody", {}, ...body)),
    );
  }

  /* A command, which may change, with a button that copies it. */
  function command(line, kind = "command") {
    const text = el("pre", {tabindex: "0"}, line);
    const copied = async () => {
      try {
        await navigator.clipboard.writeText(text.textContent);
        button.textContent = "Copied";
      } catch {
        getSelection().selectAllChildren(text); // a browser may not let a page write there
        button.textContent = "Selected";
      }
      setTimeout(() => (button.textContent = "Copy"), 2000);
    };
    const named = {"aria-label": "Copy the command", click: copied};
    const button = el("button", {type: "button", class: "small", ...named}, "Copy");
    return el("div", {class: kind}, text, button);
  }

  const unit = (text) => (text === "1" ? "" : text.replace(/\*/g, "·").replace(/\^2/g, "²").replace(/\^3/g, "³"));

  return {table, command, unit};
})();
