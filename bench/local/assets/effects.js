"use strict";
/* The third and the fourth step: which effect is missing, and effects that are tried by ticking them. */
const Effects = (() => {
  const {el, percent, quantity, unit} = Dom;
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
      for (const part of [missing, body]) part.replaceChildren(el("p", {class: "aid"}, "First a dataset is needed."));
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
    missing.replaceChildren(...step, ...(diagnosis ? verdict(run) : []));
  }

  /* What a diagnosis says: the error as effects are added, and the verdict on each. */
  function verdict(run) {
    const words = (names) =>
      names
        .map((name) => spoken(name))
        .join(", ")
        .replace(/, ([^,]*)$/, " and $1");
    const steps = diagnosis.ladder.map((step, i) => {
      const before = i ? diagnosis.ladder[i - 1].effects : [];
      return [
        i ? `+ ${words(step.effects.filter((name) => !before.includes(name)))}` : "the model as it is",
        step.error.validate ?? step.error.identify,
        i ? "" : "before",
      ];
    });
    steps.push(["noise of the currents", diagnosis.unexplained.noise_floor, "noise"]);
    const most = Math.max(...steps.map(([, share]) => share || 0));
    const changed = diagnosis.ladder.length > 1 || diagnosis.discovered.length > 0;
    const shown = diagnosis.ranking.filter((told) => told.verdict !== "not supported" && told.verdict !== "absorbed");
    const table = (list, sized = false) =>
      Dom.table(
        ["effect", "verdict", "at", ...(sized ? ["value ± standard error"] : []), "why"],
        list.map((told) => [
          spoken(told.effect),
          el("span", {class: `badge ${told.verdict.replace(/ .*/, "")}`}, told.verdict),
          told.actuators.join(", "),
          ...(sized ? [el("span", {}, ...sizes(told.effect))] : []),
          el("span", {}, ...Dom.sentence(told.why)),
        ]),
        ["keep", "keep", "", ...(sized ? ["keep"] : []), "words"],
      );
    const dataset = /\bdiagnose ('[^']+'|\S+)/.exec(run.line); // as a command is given it
    const real = (text) => (dataset ? text.replace(" DATASET ", () => ` ${dataset[1]} `) : text);
    return [
      el("div", {class: "verdict"}, ...diagnosis.summary.map((text) => el("p", {}, ...Dom.sentence(real(text))))),
      el("p", {class: "aid"}, "Error on recordings that were not fitted, as effects are added:"),
      bars(steps, most),
      shown.length ? table(shown, true) : null,
      ...(diagnosis.discovered.length ? laws() : []),
      Gains.part(diagnosis.after, changed ? diagnosis.before : null),
      diagnosis.missing.length || diagnosis.discovered.length ? applying(run) : null,
      el("details", {}, el("summary", {}, `All ${diagnosis.ranking.length} verdicts`), table(diagnosis.ranking)),
      Errors.links(run, "the model that was found"),
    ].filter((part) => part !== null);
  }

  /* How large an effect is in the model that was found, a line for each of its values. */
  function sizes(effect) {
    return Object.entries(diagnosis.after.effect_parameters[effect] || {}).flatMap(([joint, values]) =>
      Object.entries(values).map(([name, found]) =>
        el("div", {}, `${joint === "robot" ? "" : `${joint}: `}${name} = ${quantity(found)} ${unit(found.unit)}`),
      ),
    );
  }

  function bars(steps, most) {
    const made = el("div", {class: "bars"});
    for (const [name, share, kind] of steps) {
      const bar = el("div", {class: `bar ${kind}`});
      bar.style.width = `${(100 * (share || 0)) / (most || 1)}%`;
      made.append(el("span", {}, name), el("span", {class: "number"}, percent(share)), el("div", {}, bar));
    }
    return made;
  }

  function spoken(name) {
    const known = app.described.effects.find((effect) => effect.name === name);
    return known ? known.spoken : name.replace(/_/g, " ");
  }

  const verdictOf = (name) => (diagnosis ? diagnosis.ranking.find((told) => told.effect === name) : undefined);
  const effects = () => [...chosen].sort();

  /* The list of effects with their places, and the answer beside it. */
  async function drawChoice() {
    const order = (effect) => {
      const at = diagnosis ? diagnosis.ranking.findIndex((two) => two.effect === effect.name) : -1;
      return at < 0 ? 1000 : at;
    };
    const list = [...app.described.effects].sort((a, b) => order(a) - order(b) || a.name.localeCompare(b.name));
    const answer = el("div", {class: "answer"});
    const boxes = list.map((effect) => {
      const said = verdictOf(effect.name);
      const legend = el(
        "legend",
        {},
        effect.words,
        said && said.verdict !== "not supported"
          ? el("span", {class: `badge ${said.verdict.replace(/ .*/, "")}`}, said.verdict)
          : null,
      );
      const places = effect.places.length
        ? effect.places.map((place) => [`${effect.name}:${place}`, place])
        : [[effect.name, "the whole robot"]];
      return el(
        "fieldset",
        {},
        legend,
        el(
          "div",
          {class: "places"},
          ...places.map(([name, words]) => {
            const input = el("input", {
              type: "checkbox",
              id: name,
              checked: chosen.has(name),
              change: () => {
                if (input.checked) chosen.add(name);
                else chosen.delete(name);
                drawAnswer(answer, true);
              },
            });
            return el("label", {}, input, words);
          }),
        ),
      );
    });
    body.replaceChildren(
      el(
        "div",
        {class: "choose"},
        el("div", {class: "effects", tabindex: "0", role: "group", "aria-label": "Effects"}, ...boxes),
        answer,
      ),
      el("div", {id: "applied"}),
    );
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
      job = await Server.run(asked);
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
    if (fault) parts.push(Dom.outcome(fault));
    if (job) {
      tried = {model: job.files.model, effects: asked.effects};
      const [found, base] = await Promise.all([Server.file(job.files.model), baseModel()]);
      if (mine !== asking) return;
      parts.push(...numbers(found, base), Dom.command(job.line), apply());
    } else {
      const {line, fault: lacks} = await Server.offer("", () => asked);
      if (mine !== asking) return;
      go.disabled = line === null;
      parts.push(el("div", {class: "row"}, go, lacks), line === null ? "" : Dom.command(line));
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
    const most = Math.max(...uses.flatMap(([use]) => [found.error[use], base ? base.error[use] || 0 : 0]));
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
      bars(steps, most),
      Gains.part(found, base),
      values.length ? Dom.table(["effect", "", "value", "unit"], values, ["", "", "right", "keep"]) : null,
    ].filter((part) => part !== null);
  }

  /* Compare a model, and go to what came of it once everything above it is drawn. */
  async function applyModel(button, model) {
    button.disabled = true;
    const job = await Server.run({step: "compare", dataset: app.dataset, models: [model]});
    button.disabled = false;
    if (job.state !== "done") return button.after(Dom.outcome(job));
    applied = job.files.run;
    await app.refresh();
    await app.drawn;
    return document.getElementById("applied").scrollIntoView({block: "start"});
  }

  function apply() {
    const button = el(
      "button",
      {
        type: "button",
        class: "main",
        id: "apply",
        click: () => applyModel(button, tried.model),
      },
      "Apply and compare",
    );
    return el(
      "div",
      {class: "row"},
      button,
      el("a", {href: `files/${Server.address(tried.model)}`, download: true}, "Download the model with these effects"),
      Errors.exporting(tried.model),
    );
  }

  /* Laws that no catalogue has, as a diagnosis found them; they are applied with its model, which names their files. */
  function laws() {
    const rows = diagnosis.discovered.map((law) => [
      law.place || "the robot",
      law.formula,
      law.terms.map((term) => `${quantity(term)} ${unit(term.unit)}`).join("; "),
      percent(law.error.validate ?? law.error.identify),
    ]);
    return [
      el("h4", {}, "Laws that no catalogue has"),
      Dom.table(["at", "law", "values", "error with it"], rows, ["keep", "words", "keep", "right"]),
    ];
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
        click: () => applyModel(button, model),
      },
      "Apply what was found",
    );
    return el("div", {class: "row"}, button, Errors.exporting(model));
  }

  /* The comparison with the model that was applied, beside the one before. */
  async function drawApplied() {
    const holder = document.getElementById("applied");
    const run = app.latest("compare", (job) => job.applied && (applied === null || job.path === applied));
    if (!run) return;
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
