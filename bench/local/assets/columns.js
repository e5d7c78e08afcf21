"use strict";
/* Which column of a log is which of a recording: chosen by clicking or by keyboard, checked after every change. */
const Columns = (() => {
  const {el, field, select, spark} = Dom;
  const PAUSE = 150; // ms without a change after which the columns are checked
  const GUESSED = {
    order: () => "taken in their order",
    unit: () => "taken for its unit",
    alike: () => "named like the position",
    rest: () => "taken as the last one",
    range: (unit) => `taken to be in ${Dom.unit(unit)} for its range`,
  };
  const told = new Map(Kept.get("units", [])); // what is measured -> the unit that was chosen for it last
  const kept = new Map(Kept.get("logs", [])); // a log and how it is read -> how its columns were mapped last
  const layouts = new Map(Kept.get("layouts", [])); // robot, headers, stated units -> the log that had them, and its mapping

  /*
  look: what the server says of the log; asked: log and robot; typed: the rate of a log without a time, in Hz;
  changed: called with the mapping, and what was typed as rate, after each change.
  */
  function create(look, asked, typed, changed) {
    const mapping = {};
    const own = (target, column) => look.stated[column] || look.units[target][0]; // the unit unless another is told
    const kind = (target) => `${target.split(".")[0]} ${look.units[target][0]}`;
    const remembered = (target, column) => {
      const unit = look.stated[column] ? "" : told.get(kind(target));
      return look.units[target].includes(unit) ? unit : "";
    };
    for (const target of look.needs) {
      const guess = look.guesses[target] || {column: "", unit: "", why: ""};
      const before = guess.unit ? "" : remembered(target, guess.column);
      mapping[target] = {...guess, unit: guess.unit || before || own(target, guess.column), before};
    }
    const key = JSON.stringify([asked.log, asked.robot, asked.skip_rows, asked.topic]);
    const headers = look.columns.map((column) => column.name);
    const layout = JSON.stringify([asked.robot, headers, look.stated]);
    const last = kept.get(key);
    const previous = last ? undefined : layouts.get(layout);
    for (const [target, chosen] of Object.entries((last || previous)?.mapping || {}))
      if (look.columns.some((column) => column.name === chosen.column))
        mapping[target] = {...chosen, before: told.has(kind(target)) ? remembered(target, chosen.column) : ""};
    const state = {
      active: look.needs.find((need) => !mapping[need].column) || look.needs[0],
      accept: last?.accept || [],
      split_gaps: last?.split_gaps || false,
      rate: Number(typed) > 0 ? Number(typed) : null,
      found: {},
      checked: false, // whether that is what is found of the columns as they are now
    };
    const targets = el("ul", {class: "targets"});
    const chips = el("div", {class: "chips", role: "group", "aria-label": "Columns of the log"});
    const as = previous ? `Columns and units are those of ${previous.log}, which has the same headers.` : "";
    const root = el(
      "div",
      {class: "mapping"},
      el(
        "div",
        {},
        el("h4", {}, "What a recording needs"),
        as ? el("p", {class: "aid", id: "layout"}, as) : null,
        targets,
      ),
      el("div", {}, el("h4", {}, `Columns of the log (${look.columns.length})`), chips),
    );
    const typedRate = el("input", {
      type: "number",
      min: "0",
      step: "any",
      placeholder: "Hz",
      id: "rate",
      value: typed,
      input: () => setRate(Number(typedRate.value) > 0 ? Number(typedRate.value) : null),
    });
    const needs = () => look.needs.filter((need) => need !== "time" || state.rate === null);
    const scaled = (several) =>
      Object.fromEntries(
        several
          .filter((need) => mapping[need].unit !== own(need, mapping[need].column))
          .map((need) => [need, mapping[need].unit]),
      );
    let timer = 0,
      round = 0;

    function check() {
      clearTimeout(timer);
      timer = setTimeout(async () => {
        const mine = ++round;
        const mapped = needs().filter((need) => mapping[need].column);
        const columns = Object.fromEntries(mapped.map((need) => [need, mapping[need].column]));
        try {
          const found = await Server.look("checks", {
            ...asked,
            columns,
            scale: scaled(mapped),
            rate: state.rate,
            split_gaps: state.split_gaps,
            accept: state.accept,
          });
          if (mine !== round) return;
          state.found = found;
        } catch (error) {
          if (mine !== round) return;
          state.found = {
            [mapped[0] || "time"]: {ok: false, problems: [{what: error.message, where: "", remedy: null}]},
          };
        }
        state.checked = true;
        draw();
        tell();
      }, PAUSE);
    }

    /* What keeps the log from being imported as it is mapped; "" where nothing does. */
    function lack() {
      if (!needs().every((need) => mapping[need].column)) return "Every line above needs a column.";
      if (!state.checked) return "The columns are being checked.";
      const poor = needs().filter((need) => state.found[need] && !state.found[need].ok);
      return poor.length ? `Mend first what stands at ${poor.join(", ")}.` : "";
    }

    function tell() {
      kept.set(key, {mapping, accept: state.accept, split_gaps: state.split_gaps});
      layouts.set(layout, {log: asked.log, mapping});
      for (const [name, entries] of Object.entries({units: told, logs: kept, layouts})) Kept.put(name, [...entries]);
      const given = needs().filter((need) => mapping[need].column);
      changed(
        {
          lack: lack(),
          columns: Object.fromEntries(
            given.filter((need) => mapping[need].column !== need).map((need) => [need, mapping[need].column]),
          ),
          scale: scaled(given),
          split_gaps: state.split_gaps,
          rate: state.rate,
          accept: state.accept,
        },
        typedRate.value,
      );
    }

    function assign(target, column) {
      const before = remembered(target, column);
      mapping[target] = {column, unit: before || own(target, column), why: "", before};
      delete state.found[target];
      change();
    }

    function tellUnit(target, unit) {
      [mapping[target].unit, mapping[target].before] = [unit, ""];
      told.set(kind(target), unit);
    }

    function change() {
      state.checked = false;
      draw();
      tell();
      check();
    }

    function remedy(target, problem) {
      const cure = problem.remedy;
      if (!cure) return null;
      if (cure.unit !== undefined && look.units[target].includes(cure.unit)) {
        return el(
          "button",
          {
            type: "button",
            class: "small",
            click: () => {
              const alike = (need) => (state.found[need]?.problems || []).some((two) => two.remedy?.unit === cure.unit);
              for (const need of needs())
                if (need.split(".")[0] === target.split(".")[0] && alike(need)) tellUnit(need, cure.unit);
              change();
            },
          },
          `It is in ${cure.unit}`,
        );
      }
      if (cure.unit !== undefined) return null;
      if (cure.split_gaps) {
        return el(
          "button",
          {
            type: "button",
            class: "small",
            click: () => {
              state.split_gaps = true;
              change();
            },
          },
          "Cut the log there",
        );
      }
      return el(
        "button",
        {
          type: "button",
          class: "small",
          click: () => {
            state.accept = [...new Set([...state.accept, cure.accept])];
            change();
          },
        },
        `That is meant: accept "${cure.accept}"`,
      );
    }

    /* What is known of a column of the recording, in a line below it; problems have their remedy beside them. */
    function said(target) {
      const chosen = mapping[target];
      if (!chosen.column) return [el("p", {class: "said"}, "choose a column")];
      const found = state.found[target];
      if (!found) return [el("p", {class: "said"}, "checking")];
      const guess = GUESSED[chosen.why] ? ` · ${GUESSED[chosen.why](chosen.unit)}: look whether it is right` : "";
      const unit = chosen.before ? ` · in ${Dom.unit(chosen.before)}, as you told before` : "";
      if (found.ok) return [el("p", {class: guess ? "said poor" : "said fine"}, `✓ checked${guess}${unit}`)];
      return found.problems.map((problem) => {
        const where = problem.where ? `${problem.where}: ` : "";
        return el("p", {class: "said poor"}, `! ${where}${problem.what}`, remedy(target, problem));
      });
    }

    function units(target) {
      return select(
        look.units[target].map((unit) => [unit, Dom.unit(unit)]),
        mapping[target].unit,
        (value) => {
          tellUnit(target, value);
          change();
        },
        {"aria-label": `Unit of ${target}`, id: `unit-${target}`},
      );
    }

    function draw() {
      const focused = document.activeElement && root.contains(document.activeElement) ? document.activeElement.id : "";
      targets.replaceChildren(
        ...needs().map((target) => {
          const chosen = mapping[target];
          const column = look.columns.find((candidate) => candidate.name === chosen.column);
          return el(
            "li",
            {class: target === state.active ? "active" : null},
            el(
              "button",
              {
                type: "button",
                class: "target",
                id: `target-${target}`,
                "aria-pressed": String(target === state.active),
                click: () => {
                  state.active = target;
                  draw();
                },
              },
              target,
            ),
            select(
              [["", "–"], ...look.columns.map((candidate) => [candidate.name, candidate.name])],
              chosen.column,
              (value) => assign(target, value),
              {"aria-label": `Column for ${target}`, id: `column-${target}`},
            ),
            units(target),
            spark(column ? column.picture : []),
            ...said(target),
          );
        }),
      );
      const taken = Object.fromEntries(needs().map((need) => [mapping[need].column, need]));
      chips.replaceChildren(
        ...look.columns.map((column, i) =>
          el(
            "button",
            {
              type: "button",
              id: `chip-${i}`,
              "aria-pressed": String(column.name in taken),
              title: column.name in taken ? `is ${taken[column.name]}` : `make it ${state.active}`,
              click: () => pick(column.name),
            },
            el("span", {class: "name"}, column.name),
            el(
              "span",
              {class: "range"},
              column.low === null
                ? "text"
                : `${ChartBasics.formatNumber(column.low, 3)} … ${ChartBasics.formatNumber(column.high, 3)}`,
            ),
            spark(column.picture),
          ),
        ),
      );
      if (focused) document.getElementById(focused)?.focus({preventScroll: true});
    }

    function pick(column) {
      assign(state.active, column);
      const next = needs().find((need) => !mapping[need].column);
      if (next) state.active = next;
      draw();
    }

    function setRate(rate) {
      state.rate = rate;
      if (rate !== null && state.active === "time") state.active = needs()[0];
      change();
    }

    draw();
    tell();
    check();
    return [root, el("div", {class: "row"}, field("No time column? Sampling rate in Hz", typedRate))];
  }

  /* Which topic of a ROS bag is meant, where several hold joint states. */
  function topics(names, chosen, changed) {
    const options = [["", "choose …"], ...names.map((name) => [name, name])];
    const choice = select(options, chosen, changed, {id: "topic"});
    return el("div", {class: "row"}, field("Topic of the joint states", choice));
  }

  /* How many lines on top of a text are no part of its table. */
  function skipped(lines, changed) {
    const typed = el("input", {
      type: "number",
      min: "0",
      step: "1",
      id: "skip",
      value: lines || "",
      placeholder: "0",
      change: () => changed(Math.max(0, Math.floor(Number(typed.value))) || 0),
    });
    return el("div", {class: "row"}, field("Lines on top to leave out", typed));
  }

  return {topics, skipped, create};
})();
