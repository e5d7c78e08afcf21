"use strict";
/* The last step: every result in the folder, and models side by side. */
const Results = (() => {
  const {el, percent, quantity, unit} = Dom;
  const chosen = new Set();
  let app,
    body,
    side = null;

  function start(given) {
    app = given;
    body = document.querySelector("#history .body");
  }

  function render() {
    if (!app.runs.length) return Dom.later(body, true, "No result in this folder yet.");
    Dom.later(body, false);
    const answer = el("div");
    const button = el(
      "button",
      {
        type: "button",
        class: "main",
        id: "side-by-side",
        disabled: chosen.size < 2,
        click: () => compare(button, answer),
      },
      "Side by side",
    );
    const rows = app.runs.map((run) => {
      if (run.fault) return ["", run.time, run.path, run.fault, "", ""];
      const input = el("input", {
        type: "checkbox",
        "aria-label": `Choose ${run.path}`,
        checked: chosen.has(run.model),
        change: () => {
          if (input.checked) chosen.add(run.model);
          else chosen.delete(run.model);
          button.disabled = chosen.size < 2;
        },
      });
      const link =
        run.path === run.model
          ? {href: `files/${Server.address(run.path)}`, download: true}
          : {href: `show/${Server.address(run.path)}/report.html`, target: "_blank", rel: "noopener"};
      return [
        input,
        run.time,
        el("a", link, run.path),
        run.effects.map(Effects.said).join(", ") || "none",
        percent(run.error.identify),
        percent(run.error.validate),
      ];
    });
    body.replaceChildren(
      Dom.table(["", "made", "result", "effects", "error, fitted", "not fitted"], rows, [
        "",
        "keep",
        "",
        "words",
        "right",
        "right",
      ]),
      el("div", {class: "row"}, button),
      answer,
    );
    if (side) show(answer, side);
    return undefined;
  }

  async function compare(button, holder) {
    const job = await Step.run(button, {step: "compare", dataset: app.dataset, models: [...chosen]});
    if (job.state !== "done") return holder.replaceChildren();
    side = {line: job.line, found: await Server.file(job.files.answer)};
    return show(holder, side);
  }

  /* A gain with its interval, to the digits that its deviation supports. */
  function gain(found) {
    if (!found.interval || !Dom.determined(found)) return quantity(found);
    const ends = found.interval.map((end) => ChartBasics.formatKnown(end, found.std));
    return `${quantity(found)} [${ends.join(", ")}]`;
  }

  function show(holder, {line, found}) {
    const names = found.models.map((model) => model.name);
    const errors = [
      ["error, fitted", ...found.models.map((model) => percent(model.error.identify))],
      ["error, not fitted", ...found.models.map((model) => percent(model.error.validate))],
      ...Object.keys(found.models[0].error.by_actuator).map((joint) => [
        `error of ${joint}`,
        ...found.models.map((model) => percent(model.error.by_actuator[joint])),
      ]),
    ];
    const gains = Object.keys(found.models[0].drive_gains).map((joint) => [
      `${joint}, ${unit(found.models[0].drive_gains[joint].unit)}`,
      ...found.models.map((model) => gain(model.drive_gains[joint])),
    ]);
    const kinds = ["", ...names.map(() => "right")];
    holder.replaceChildren(
      Dom.command(line),
      el("div", {class: "part"}, Dom.table(["", ...names], errors, kinds)),
      el(
        "div",
        {class: "part"},
        el("h3", {}, "Drive gains ± standard error, 95 % interval"),
        Dom.table(["", ...names], gains, kinds),
      ),
      el(
        "div",
        {class: "part"},
        el("h3", {}, "What changed"),
        el("ul", {class: "said"}, ...found.changed.map((text) => el("li", {}, text))),
      ),
    );
  }

  return {start, render};
})();
