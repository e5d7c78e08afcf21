"use strict";
/* What a diagnosis says: a card for each effect that is established, the gains with them, reasons, laws and verdicts. */
const Answer = (() => {
  const {el, percent, quantity, unit} = Dom;
  const QUIET = ["not supported", "absorbed"]; // verdicts that stand in the list of all alone
  const TYPED = /`(bench [^`]*)`\.?/; // a command in a sentence

  /* diagnosis: as JSON; run: its result; spoken: the name of an effect in words; applying: what applies its model. */
  function create({diagnosis, run, spoken, applying}) {
    const changed = diagnosis.ladder.length > 1 || diagnosis.discovered.length > 0;
    const established = diagnosis.missing.map((name) => diagnosis.ranking.find((told) => told.effect === name));
    const others = diagnosis.ranking.filter((told) => !QUIET.includes(told.verdict) && !established.includes(told));
    const gains = Gains.part(diagnosis.after, changed ? diagnosis.before : null, established.length > 0);
    const cards = established.map((told) => card(told, diagnosis, spoken));
    return [
      cards.length ? el("div", {class: "answered"}, el("div", {class: "cards"}, ...cards), gains) : null,
      el("div", {class: cards.length ? "verdict told" : "verdict"}, ...sentences(diagnosis, run)),
      el("p", {class: "aid"}, "Error on recordings that were not fitted, as effects are added:"),
      Bars.create(ladder(diagnosis, spoken)),
      others.length ? verdicts(others, spoken) : null,
      ...(diagnosis.discovered.length ? laws(diagnosis) : []),
      cards.length ? null : gains,
      applying,
      el(
        "details",
        {},
        el("summary", {}, `All ${diagnosis.ranking.length} verdicts`),
        verdicts(diagnosis.ranking, spoken),
      ),
      Errors.links(run, "the model that was found"),
    ].filter((part) => part !== null);
  }

  const badge = (verdict) => el("span", {class: `badge ${verdict.replace(/ .*/, "")}`}, verdict);

  /* One effect: where, how large, what it saves, and why. */
  function card(told, diagnosis, spoken) {
    const where = told.actuators.length ? ` at ${told.actuators.join(", ")}` : "";
    const name = spoken(told.effect).replace(/^./, (first) => first.toUpperCase());
    const saves = `error ${percent(told.error_before)} → ${percent(told.error_after)}`;
    const probable = told.probability === undefined ? null : `probability ${probability(told.probability)}`;
    return el(
      "article",
      {class: "card"},
      el("h4", {}, `${name}${where} `, badge(told.verdict)),
      el("div", {class: "size"}, ...sizes(told.effect, diagnosis)),
      el("p", {class: "saves"}, ...[saves, probable].filter(Boolean).map((text) => el("span", {}, text))),
      el("p", {class: "why"}, ...Dom.sentence(told.why)),
    );
  }

  /* As the terminal writes it. */
  function probability(share) {
    if (share < 0.01) return "< 0.01";
    return share > 0.99 ? "> 0.99" : share.toFixed(2);
  }

  /* How large an effect is in the completed model, a line for each of its values. */
  function sizes(effect, diagnosis) {
    const places = Object.entries(diagnosis.after.effect_parameters[effect] || {});
    return places.flatMap(([place, values]) =>
      Object.entries(values).map(([name, found]) =>
        el("div", {}, `${places.length > 1 ? `${place}: ` : ""}${name} = ${quantity(found)} ${unit(found.unit)}`),
      ),
    );
  }

  /* The sentences of the answer; a command in one of them has a line of its own, with the dataset that was diagnosed. */
  function sentences(diagnosis, run) {
    const dataset = /\bdiagnose ('[^']+'|\S+)/.exec(run.line); // as a command is given it
    const real = (line) =>
      dataset
        ? line.replace(" DATASET ", () => ` ${dataset[1]} `).replace(/ -o DIR$/, () => ` -o ${motion(dataset[1])}`)
        : line;
    return diagnosis.summary.flatMap((text) => {
      const [before, line, after] = text.split(TYPED);
      return [
        el("p", {}, ...Dom.sentence(before)),
        line === undefined ? null : Dom.command(real(line)),
        after ? el("p", {}, ...Dom.sentence(after)) : null,
      ].filter((part) => part !== null);
    });
  }

  const motion = (word) => (word.endsWith("'") ? `${word.slice(0, -1)}.motion'` : `${word}.motion`);

  function ladder(diagnosis, spoken) {
    const words = (names) =>
      names
        .map(spoken)
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
    return [...steps, ["noise of the currents", diagnosis.unexplained.noise_floor, "noise"]];
  }

  function verdicts(list, spoken) {
    const rows = list.map((told) => [
      spoken(told.effect),
      badge(told.verdict),
      told.actuators.join(", "),
      el("span", {}, ...Dom.sentence(told.why)),
    ]);
    return Dom.table(["effect", "verdict", "at", "why"], rows, ["keep", "keep", "", "words"]);
  }

  /* Laws that no catalogue has; they are applied with the model, which names their files. */
  function laws(diagnosis) {
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

  return {create, badge};
})();
