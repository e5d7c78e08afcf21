"use strict";
/* The third and the fourth step: which effect is missing, and effects that are tried by ticking them. */
const Effects = (() => {
  const {el, quantity, unit} = Dom;
  const [FOUND, TRIED] = ["applied-found", "applied"]; // where the result of an applied model stands
  let app,
    missing,
    body,
    round = 0,
    asking = 0;
  const chosen = new Set();
  const models = new Map(); // effects -> the model that was identified with them, this time
  let tried = null,
    shownOf = null,
    applied = null,
    diagnosis = null;

  function start(given) {
    app = given;
    missing = document.querySelector("#missing .body");
    body = document.querySelector("#effects .body");
  }

  async function render() {
    const mine = ++round;
    if (!app.described) {
      for (const part of [missing, body]) Dom.later(part, true, app.awaited());
      return;
    }
    const run = app.latest("diagnosis", () => true);
    const found = run ? await Server.file(`${run.path}.json`).catch(() => null) : null;
    const offered = await Server.offer("", () => ({step: "diagnose", dataset: app.dataset}));
    if (mine !== round) return;
    const key = run ? `${app.dataset}\n${run.path}` : `${app.dataset}\n`;
    if (key !== shownOf) {
      shownOf = key;
      [tried, applied] = [null, null];
      chosen.clear();
      const known = (request) => app.described.effects.some((effect) => effect.name === request.split(":")[0]);
      for (const request of found ? found.after.effects.filter(known) : []) chosen.add(request);
    }
    diagnosis = found;
    drawMissing(run, offered);
    await drawChoice();
  }

  function drawMissing(run, {line, fault: lacks}) {
    const asked = () => ({step: "diagnose", dataset: app.dataset});
    const label = run ? "Diagnose again" : "Diagnose";
    const step = Step.create({label, id: "diagnose", asked, line, lacks, done: () => app.refresh()});
    const applies = diagnosis && (diagnosis.missing.length || diagnosis.discovered.length) ? applying(run) : null;
    Dom.later(missing, false);
    missing.replaceChildren(...step, ...(diagnosis ? Answer.create({diagnosis, run, spoken, applying: applies}) : []));
  }

  function spoken(name) {
    const known = app.described?.effects.find((effect) => effect.name === name);
    return known ? known.spoken : name.replace(/_/g, " ");
  }

  const effects = () => [...chosen].sort();

  /* The effects with their places, and the answer to those that are ticked; folded away before a diagnosis. */
  async function drawChoice() {
    const answer = el("div", {class: "answer"});
    const {effects: known, groups} = app.described;
    const {ranking, missing: established} = diagnosis || {ranking: [], missing: []};
    const changed = () => drawAnswer(answer, true);
    const list = Choosing.create({effects: known, groups, ranking, missing: established, chosen, changed});
    const choose = el("div", {class: "choose"}, list, answer);
    const folded = () => el("details", {}, el("summary", {}, "After a diagnosis, or from the whole list"), choose);
    Dom.later(body, !diagnosis);
    body.replaceChildren(diagnosis ? choose : folded(), el("div", {id: TRIED}));
    await drawAnswer(answer, false);
    await drawApplied();
  }

  /* The model with the effects that are ticked; it is identified if it has not been, and `now` is said. */
  async function drawAnswer(holder, now) {
    const mine = ++asking;
    const asked = {step: "identify", dataset: app.dataset, effects: effects()};
    const key = JSON.stringify([app.dataset, asked.effects]);
    holder.classList.add("waiting");
    let job = models.get(key),
      fault = null;
    if (!job && now) {
      const [running, show] = Step.progress();
      const row = holder.querySelector(".row");
      if (row) row.after(running);
      else holder.prepend(running);
      job = await Server.run(asked, show).finally(() => running.remove());
      if (job.state === "done") models.set(key, job);
      else [fault, job] = [job, null];
    }
    if (mine !== asking) return;
    const title = asked.effects.length ? `With ${asked.effects.map(said).join(", ")}` : "Without any effect";
    const go = el(
      "button",
      {type: "button", class: "main", id: "identify", click: () => drawAnswer(holder, true)},
      "Identify with these",
    );
    const parts = [el("h3", {}, title)];
    if (job) {
      tried = {model: job.files.model, effects: asked.effects};
      const [found, base] = await Promise.all([Server.file(job.files.model), baseModel()]);
      if (mine !== asking) return;
      parts.push(...numbers(found, base), Dom.command(job.line), ...apply());
    } else {
      const {line, fault: lacks} = await Server.offer("", () => asked);
      if (mine !== asking) return;
      go.disabled = line === null;
      parts.push(el("div", {class: "row"}, go, lacks));
      if (fault) parts.push(Dom.outcome(fault));
      if (line !== null) parts.push(Dom.command(line));
    }
    holder.classList.remove("waiting");
    holder.replaceChildren(...parts);
  }

  const said = (request) => {
    const [name, place] = request.split(":");
    return place ? `${spoken(name)} at ${place}` : spoken(name);
  };

  async function baseModel() {
    const run = app.latest("compare", (job) => !job.applied);
    return run ? Server.file(run.model).catch(() => null) : null;
  }

  /* Errors and gains of a model beside those of the model without effects. */
  function numbers(found, base) {
    const uses = [
      ["identify", "fitted"],
      ["validate", "not fitted"],
    ].filter(([use]) => found.error[use] !== null);
    const steps = uses.flatMap(([use, words]) => [
      ...(base ? [[`${words}, before`, base.error[use], "before"]] : []),
      [base ? `${words}, now` : words, found.error[use], ""],
    ]);
    const values = Object.entries(found.effect_parameters).flatMap(([effect, joints]) =>
      Object.entries(joints).flatMap(([joint, list]) =>
        Object.entries(list).map(([name, quantified]) => [
          `${spoken(effect)}${joint === "robot" ? "" : ` at ${joint}`}`,
          name,
          quantity(quantified),
          unit(quantified.unit),
        ]),
      ),
    );
    return [
      Bars.create(steps),
      Gains.part(found, base),
      values.length ? Dom.table(["effect", "", "value", "unit"], values, ["", "", "right", "keep"]) : null,
    ].filter((part) => part !== null);
  }

  /* Compare a model, and go to what came of it, below its button, once everything above it is drawn. */
  async function applyModel(button, model, place) {
    const job = await Step.run(button, {step: "compare", dataset: app.dataset, models: [model]});
    if (job.state !== "done") return;
    applied = {run: job.files.run, place};
    await app.refresh();
    await app.drawn;
    document.getElementById(place).scrollIntoView();
  }

  function apply() {
    const button = el(
      "button",
      {
        type: "button",
        class: "main",
        id: "apply",
        click: () => applyModel(button, tried.model, TRIED),
      },
      "Apply and compare",
    );
    const {controls, said: exported} = Errors.exporting(tried.model);
    const href = `files/${Server.address(tried.model)}`;
    const link = el("a", {href, download: true}, "Download the model with these effects");
    return [el("div", {class: "row"}, button, ...controls, link), exported];
  }

  /* The model that a diagnosis found, compared: what its ticks give, and its laws as well. */
  function applying(run) {
    const model = `${run.path}-model.json`;
    const button = el(
      "button",
      {
        type: "button",
        class: "main",
        id: "apply-found",
        click: () => applyModel(button, model, FOUND),
      },
      "Apply what was found",
    );
    const {controls, said: exported} = Errors.exporting(model);
    return el("div", {}, el("div", {class: "row"}, button, ...controls), exported, el("div", {id: FOUND}));
  }

  /* The comparison with the model that was applied, beside the one before. */
  async function drawApplied() {
    const run = app.latest("compare", (job) => job.applied && (applied === null || job.path === applied.run));
    if (!run) return;
    const same = (names) => names.toSorted().join() === run.effects.toSorted().join();
    const place = applied?.place ?? (diagnosis && same(diagnosis.after.effects) ? FOUND : TRIED);
    const holder = document.getElementById(place) || document.getElementById(TRIED);
    const answer = el("div", {class: "part"});
    holder.replaceChildren(
      el(
        "div",
        {class: "panel"},
        el("h3", {}, `Applied: ${run.effects.map(said).join(", ") || "no effect"}`),
        Dom.command(run.line),
        answer,
      ),
    );
    await Errors.show(
      answer,
      run,
      "the applied model",
      app.latest("compare", (job) => !job.applied),
    );
  }

  return {start, render, said};
})();
