"use strict";
/* What the workbench's section is made of: headings, tiles, buttons, and places for lists, tables and charts. */
const WorkbenchSkeleton = (() => {
  const {el} = ChartBasics;

  function segments(parent, name, options, changed) {
    const select = el("select", {"aria-label": name, change: () => changed(Number(select.value))});
    select.append(...options.map((option, i) => el("option", {value: i}, option)));
    parent.append(el("fieldset", {}, el("legend", {}, name), select));
    return select;
  }

  function tile(name) {
    const [value, note] = [el("dd"), el("dd", {class: "note"})];
    return {value, note, box: el("div", {class: "tile"}, el("dt", {}, name), value, note)};
  }

  const aid = (text) => el("p", {class: "aid"}, text);
  const button = (text, title = null) => el("button", {type: "button", title}, text);
  const part = (title, ...children) => el("div", {class: "part"}, el("h3", {}, title), ...children);

  function skeleton(section) {
    const copied = Elements.command("", "bench-command");
    const parts = {
      judged: tile("Error, not fitted"),
      fitted: tile("Error, fitted"),
      found: button("Found by diagnose"),
      nothing: button("Nothing"),
      pin: button("Keep as A", "Keep this model, to see another one beside it"),
      pinned: el("p", {class: "bench-pinned"}),
      said: el("p", {class: "bench-said", role: "status"}),
      list: el("ul", {class: "bench-effects"}),
      hidden: aid(""),
      alone: el("p", {class: "bench-alone"}),
      ladder: el("div", {class: "chart"}),
      gains: el("div"),
      choices: el("div", {class: "choices"}),
      aid: aid(""),
      curves: el("div", {class: "chart"}),
      parameters: el("div"),
      command: copied.querySelector("pre"),
      download: button("Download model"),
      file: el("span", {class: "aid"}),
    };
    const {judged, fitted, pin, found, nothing} = parts;
    const effects = el(
      "div",
      {class: "bench-list"},
      el("h3", {}, "Effects"),
      aid("Beside each: the error on recordings that were not fitted, if you tick it or take it out."),
      parts.list,
      parts.hidden,
    );
    const answer = el(
      "div",
      {class: "bench-answer"},
      part(
        "Error, effect by effect",
        aid("From the model without any effect; at each step the one that helps most."),
        parts.alone,
        parts.ladder,
      ),
      part(
        "Drive gains and errors",
        aid(
          "After ±: standard error of the gain, known of the models that diagnose fitted; bench identify tells it of others. Fitted, not fitted: error of this motor's current.",
        ),
        parts.gains,
      ),
      part("Currents", parts.choices, parts.aid, parts.curves),
      part(
        "The same on the command line",
        aid("With its shapes fitted anew, and all standard errors."),
        copied,
        el("p", {class: "bench-model"}, parts.download, parts.file),
      ),
      el("div", {class: "part"}, el("details", {}, el("summary", {}, "Dynamic parameters"), parts.parameters)),
    );
    section.classList.add("bench");
    section.append(
      el("h2", {}, "Workbench"),
      el(
        "p",
        {class: "lead"},
        "Tick an effect, and this page fits gains and all that enters linearly anew, at once. Shapes, such as a speed or a period, stay as diagnose found them; the command below fits them anew, too.",
      ),
      el(
        "div",
        {class: "bench-now"},
        el("dl", {class: "tiles"}, judged.box, fitted.box),
        el("div", {class: "bench-buttons"}, pin, found, nothing),
      ),
      parts.pinned,
      parts.said,
      el("div", {class: "bench-grid"}, effects, answer),
    );
    return parts;
  }

  /* The command with these effects; line: as far as it does not depend on them. A word is as a shell takes it. */
  function command(line, requests) {
    const quoted = (word) => (/^[\w\-./:=,+~]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);
    return [line, ...requests.map((request) => `--with ${quoted(request)}`)].join(" \\\n  ");
  }

  /* Hand the reader a file. */
  function saved(content, name) {
    const file = new Blob([`${JSON.stringify(content, null, 1)}\n`], {type: "application/json"});
    const link = el("a", {href: URL.createObjectURL(file), download: name});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  /* A table whose columns of numbers stand right. */
  function table(holder, heads, rows) {
    const kinds = heads.map((_, i) => (i ? "right" : ""));
    holder.replaceChildren(Elements.table(heads, rows, kinds));
  }

  return {segments, skeleton, table, command, saved};
})();
