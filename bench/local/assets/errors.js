"use strict";
/* The second step: where a model fails; and how such an answer is shown wherever it is one. */
const Errors = (() => {
  const {el, percent} = Dom;
  let app,
    body,
    round = 0;
  const remembered = {}; // choices of the figure, by name

  function start(given) {
    app = given;
    body = document.querySelector("#errors .body");
  }

  async function render() {
    const mine = ++round;
    if (!app.described) return Dom.later(body, true, app.awaited());
    const asked = {step: "compare", dataset: app.dataset};
    const {line, fault} = await Server.offer("", () => asked);
    const run = app.latest("compare", (job) => !job.applied);
    const answer = el("div");
    if (mine !== round) return undefined;
    const step = {
      label: run ? "Compare again" : "Compare",
      id: "compare",
      asked: () => asked,
      line,
      lacks: fault,
      done: () => app.refresh(),
    };
    Dom.later(body, false);
    body.replaceChildren(...Step.create(step), answer);
    return run ? show(answer, run, "the model without effects") : undefined; // a chart needs its place in the page
  }

  /*
  Shows a run of `compare`: sentences, errors by motor, curves, files. called: what its model is; before: another
  one, for the curves.
  */
  async function show(holder, run, called, before = null) {
    let found, gains;
    try {
      const models = before ? [run, before] : [run];
      [found, ...gains] = await Promise.all(
        [`${run.path}.json`, ...models.map((model) => model.model)].map(Server.file),
      );
    } catch {
      return holder.replaceChildren(links(run, called)); // made in a shell, without --json
    }
    const joints = Object.keys(found.where);
    const sentences = joints.flatMap((joint) => {
      const {text, follows, looks_like: alike = []} = found.where[joint];
      const said = [text, ...follows.map((finding) => finding.text)].map(Dom.sentence);
      return [...said, ...alike.map((finding) => [...Dom.sentence(finding.text), " ", laws(run)])];
    });
    let figures = null; // once they are drawn
    const goTo = (joint, recording) => figures?.go({Motor: is(joint), Recording: begins(recording)});
    const recordings = Object.keys(found.where[joints[0]]?.by_recording || {});
    const rows = joints.map((joint) => [
      joint,
      percent(found.where[joint].error),
      percent(found.where[joint].noise),
      ...recordings.map((name) => place(joint, name, found.where[joint].by_recording[name], goTo)),
    ]);
    const models = before
      ? [
          {path: before.model, name: "before", role: "before"},
          {path: run.model, name: "after", role: "after"},
        ]
      : [{path: run.model, name: "", role: "error"}];
    const figure = el("div", {class: "part"});
    holder.replaceChildren(
      el("ul", {class: "said"}, ...sentences.map((said) => el("li", {}, ...said))),
      found.shares ? el("p", {class: "aid"}, found.shares) : "",
      el(
        "div",
        {class: "part"},
        Dom.table(
          ["motor", "error", "noise of the current", ...recordings],
          rows,
          ["", ...Array.from({length: 2 + recordings.length}, () => "right")],
          "stacked",
        ),
        recordings.length ? el("p", {class: "aid"}, "An error that is clicked is shown by the curves below.") : "",
      ),
      Gains.part(...gains),
      figure,
      links(run, called),
    );
    figures = await curves(figure, models);
    return undefined;
  }

  const is = (wanted) => (option) => option === wanted;
  const begins = (wanted) => (option) => option === wanted || option.startsWith(`${wanted} (`);

  /* The error of a motor in a recording: clicked, the curves show it. */
  function place(joint, recording, errors, goTo) {
    if (!errors) return "–";
    const named = `Show ${joint} in ${recording}`;
    const click = () => goTo(joint, recording);
    return el("button", {type: "button", class: "place", "aria-label": named, click}, percent(errors.error));
  }

  async function curves(holder, models) {
    try {
      const found = await Server.look("curves", {dataset: app.dataset, models});
      if (found.type !== "figure") return null;
      const [figure, robot] = [el("div"), el("div", {class: "part"})];
      holder.replaceChildren(figure, robot);
      const recording = found.choices.find((choice) => choice.name === "Recording");
      const shown = () => (remembered.Recording || recording.options[recording.first]).replace(/ \([^()]*\)$/, "");
      let machine = null;
      const open = async () => {
        try {
          const asked = {dataset: app.dataset, model: models[models.length - 1].path, recording: shown()};
          machine = Machine.create(robot, await Server.look("machine", asked));
        } catch (error) {
          robot.replaceChildren(el("p", {class: "fault"}, error.message));
        }
      };
      const figures = Figures.show(figure, found, remembered, () => machine && open());
      figure.addEventListener("cursor", (event) => machine && machine.at(event.detail));
      robot.append(el("button", {type: "button", class: "robot", click: open}, "Show the robot in motion"));
      return figures;
    } catch (error) {
      holder.replaceChildren(el("p", {class: "fault"}, error.message));
      return null;
    }
  }

  /* The report has the laws of the effects that leave such errors. */
  function laws(run) {
    const href = `show/${Server.address(run.path)}/report.html#laws-alike`;
    return el("a", {href, target: "_blank", rel: "noopener"}, "Laws, and what shows them");
  }

  /* called: what its model is. */
  function links(run, called) {
    return el(
      "p",
      {class: "row"},
      el(
        "a",
        {href: `show/${Server.address(run.path)}/report.html`, target: "_blank", rel: "noopener"},
        "Open the report",
      ),
      el("a", {href: `files/${Server.address(run.path)}/report.html`, download: true}, "Download the report"),
      run.model ? el("a", {href: `files/${Server.address(run.model)}`, download: true}, `Download ${called}`) : null,
    );
  }

  /* A model for other programs: its form and the button of a row; below that row, the command and the file that came of it. */
  function exporting(model) {
    const forms = [
      ["mjcf", "MuJoCo (MJCF)"],
      ["urdf", "URDF"],
      ["csv", "a table (CSV)"],
      ["yaml", "a table (YAML)"],
      ["c", "a feed-forward in C"],
    ];
    const download = (file) =>
      el("a", {href: `files/${Server.address(file)}`, download: true}, `Download ${file.split("/").pop()}`);
    let form = "mjcf";
    const said = el("div");
    const button = el(
      "button",
      {
        type: "button",
        class: "export",
        click: async () => {
          const job = await Step.run(button, {step: "export", dataset: app.dataset, model, form});
          if (job.state !== "done") return;
          said.replaceChildren(
            el("p", {class: "row"}, ...Object.values(job.files).map(download)),
            el("pre", {tabindex: "0", class: "exported"}, job.output.trim()),
            Dom.command(job.line),
          );
        },
      },
      "Export",
    );
    const choice = Dom.select(forms, form, (value) => (form = value), {"aria-label": "Form of the export"});
    return {controls: [choice, button], said};
  }

  return {start, render, exporting, show, curves, links};
})();
