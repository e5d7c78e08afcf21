"use strict";
/* The runs of a sweep as a table: filtered by its axes, by a "pick" in a chart, and chosen for a command. */
window.Runs = (() => {
  const {block, formatNumber, formatPercent} = ChartBasics;
  const MOST = 100; // rows that are shown at once
  const ALL = "";

  function textOf(column, i) {
    const value = column.values[i];
    if (value === null) return "–";
    if (column.labels.length) return column.labels[value];
    if (typeof value === "string") return value;
    return column.kind === "share" ? formatPercent(value) : formatNumber(value, 5);
  }

  /* A question with its answers; `changed` is called with every new one. */
  function question(name, answers, parent, changed) {
    const field = block("fieldset", "", parent);
    block("legend", "", field, name);
    const select = block("select", "", field);
    select.setAttribute("aria-label", name);
    for (const [value, text] of answers) {
      const option = block("option", "", select, text);
      option.value = value;
    }
    select.addEventListener("change", changed);
    return select;
  }

  function start(holder, runs) {
    const {columns} = runs;
    const chosen = new Set();
    const numbers = columns[0].values;
    const failures = numbers.some((run) => runs.failed[run]);
    holder.classList.add("runs");
    const choices = block("div", "choices", holder);
    const filters = columns
      .filter((column) => column.labels.length > 1)
      .map((column) => {
        const answers = [[ALL, "all"], ...column.labels.map((label, i) => [String(i), label])];
        return [column, question(column.header, answers, choices, () => show())];
      });
    const measured = columns.filter((column, i) => i > 0 && !column.labels.length && column.header !== "seed");
    const orders = [[ALL, "by number"], ...measured.map((column, i) => [String(i), `${column.header}, largest first`])];
    const order = question("Order", orders, choices, () => show());
    const told = block("p", "shown", holder);
    const scroll = block("div", "scroll", holder);
    Object.assign(scroll, {tabIndex: 0, role: "region", ariaLabel: runs.title});
    const table = block("table", "", scroll);
    table.setAttribute("aria-multiselectable", "true");
    const head = block("tr", "", block("thead", "", table));
    for (const column of columns)
      block("th", column.labels.length ? "keep" : "right", head, column.header).scope = "col";
    if (failures) block("th", "words", head, "failed").scope = "col";
    const body = block("tbody", "", table);
    const commands = block("div", "command", holder);
    const line = block("pre", "", commands);
    line.tabIndex = 0;
    const copy = block("button", "", commands, "Copy");
    copy.type = "button";
    copy.addEventListener("click", () => {
      getSelection().selectAllChildren(line);
      document.execCommand("copy"); // a file that was opened from a disk has no clipboard of its own
      copy.textContent = "Copied";
      setTimeout(() => (copy.textContent = "Copy"), 1500);
    });

    function say() {
      const several = [...chosen].map((run) => ` --run ${run}`).join("");
      line.textContent = runs.command + several;
    }

    function choose(row, run) {
      if (!chosen.delete(run)) chosen.add(run);
      row.setAttribute("aria-selected", String(chosen.has(run)));
      say();
    }

    function rowOf(i) {
      const run = numbers[i];
      const row = block("tr", runs.failed[run] ? "weak" : "", body);
      row.tabIndex = 0;
      row.setAttribute("aria-selected", String(chosen.has(run)));
      for (const column of columns) block("td", column.labels.length ? "keep" : "right", row, textOf(column, i));
      if (failures) block("td", "words", row, runs.failed[run] || "");
      row.addEventListener("click", () => choose(row, run));
      row.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        choose(row, run);
      });
    }

    function show() {
      const wanted = filters
        .filter(([, select]) => select.value !== ALL)
        .map(([column, select]) => [column, Number(select.value)]);
      const rows = [...numbers.keys()].filter((i) => wanted.every(([column, value]) => column.values[i] === value));
      if (order.value !== ALL) {
        const by = measured[Number(order.value)].values;
        const size = (i) => (typeof by[i] === "number" ? by[i] : -Infinity);
        rows.sort((a, b) => size(b) - size(a));
      }
      const more = rows.length > MOST ? `; the first ${MOST} are shown` : "";
      told.textContent = `${rows.length} of ${numbers.length} runs${more}.`;
      body.replaceChildren();
      rows.slice(0, MOST).forEach(rowOf);
      say();
    }

    document.addEventListener("pick", (event) => {
      for (const [column, select] of filters) {
        const label = event.detail[column.axis];
        select.value = label === undefined ? ALL : String(column.labels.indexOf(label));
      }
      show();
      holder.closest("section").scrollIntoView();
    });
    show();
  }

  return {start};
})();
