"use strict";
/* The workbench: tick effects, and see errors, gains, ladder and curves of the model that has them. */
(() => {
  const {spoken, titled, unitOf, rowOf} = WorkbenchList;
  const {segments, skeleton, table} = WorkbenchSkeleton;
  const SLICE = 14; // ms of solving between two looks at the page
  const MOST_STEPS = 6; // effects of which a ladder is made

  function start(section, data, Charts) {
    const {formatNumber} = Charts;
    const models = WorkbenchModels.create(data);
    const {places, judging, ofJudging} = models;
    const drawn = data.whole || data; // what gains and curves are of
    const curves = WorkbenchCurves.create(drawn);
    const parts = skeleton(section, data);
    const chosenPlaces = new Map(); // at which places an effect was ticked last
    let state = WorkbenchChoice.start(drawn, places);
    const foundTicks = new Set(state.ticks);
    const judgedAny = data.motors.some((motor) => motor.judged.squares > 0);
    const errorOf = (fit) => (judgedAny ? fit.judged : fit.fitted);
    const percent = (share, digits = 3) => (share === null ? "–" : `${formatNumber(100 * share, digits)} %`);
    const apart = data.judged_on.replace(/, not fitted$/, "");
    const many = Boolean(data.basis || drawn.basis); // effects: more than can be fitted in an instant
    let task = 0;
    let shown = null;
    let began = 0;

    const ownOf = (name) => places.filter((place) => place.effect === name);
    /* For ladder and ticks: the model that judges, or of many effects nearly the same, from a model nearby. */
    function* lookedAt(ticks, near) {
      yield;
      return many ? judging.nearly(ticks, state.held, near) : yield* judging.fitted(ticks, state.held);
    }

    function switched(name) {
      const ticks = new Set(state.ticks);
      const own = ownOf(name).map((place) => place.key);
      if (own.some((key) => ticks.has(key))) own.forEach((key) => ticks.delete(key));
      else (chosenPlaces.get(name) || own).forEach((key) => ticks.add(key));
      return ticks;
    }

    function remember() {
      for (const {name} of data.effects) {
        const ticked = ownOf(name).map((place) => place.key).filter((key) => state.ticks.has(key));
        if (ticked.length) chosenPlaces.set(name, ticked);
      }
    }

    /* A new choice; kept in the address as a step that the back button takes back, unless it is in passing. */
    function choose(changes, lasting = true) {
      state = {...state, ...changes};
      remember();
      const hash = WorkbenchChoice.written(drawn, places, state);
      if (lasting && location.hash !== hash) location.hash = hash;
      draw(lasting);
    }

    const actions = {
      effect: (name) => choose({ticks: switched(name)}),
      place(key, on) {
        const ticks = new Set(state.ticks);
        if (on) ticks.add(key);
        else ticks.delete(key);
        choose({ticks});
      },
      hold(key, value, lasting) {
        const held = {...state.held};
        if (value === undefined) delete held[key];
        else held[key] = value;
        choose({held}, lasting);
      },
    };

    const rows = data.effects
      .filter((effect) => effect.places.length)
      .sort((a, b) => a.rank - b.rank)
      .map((effect) => rowOf(parts.list, effect, ownOf(effect.name), (value) => formatNumber(value, 4), actions));
    const unseen = data.effects.filter((effect) => !effect.places.length).map((effect) => spoken(effect.name));
    parts.hidden.textContent = unseen.length
      ? `Not listed, since the model's own parameters take them up and no data of this robot can show them: ${unseen.join(", ")}.`
      : "";
    parts.found.addEventListener("click", () => choose({ticks: new Set(foundTicks), held: {}}));
    parts.nothing.addEventListener("click", () => choose({ticks: new Set(), held: {}}));
    const motor = segments(parts.choices, "Motor", data.motors.map((one) => one.joint), (i) => choose({motor: i}));
    const named = drawn.recordings.map((one) => `${one.name}${one.use === "identify" ? "" : " (not fitted)"}`);
    const recording = segments(parts.choices, "Recording", named, (i) => choose({recording: i}));
    const ladderChart = Charts.create(parts.ladder, ladderFigure([["no effect", null]]));
    let curveChart = null;

    function ladderFigure(steps) {
      const line = (role, name, use) => ({
        kind: "line",
        role,
        name,
        marker: true,
        x: {start: 0, step: 1},
        y: steps.map(([, fit]) => (fit ? fit[use] : null)),
        texts: steps.map(([, fit]) => (fit && use === "judged" ? percent(fit[use]) : "")),
      });
      const lines = [line("before", "fitted", "fitted")];
      if (judgedAny) lines.push(line("after", "not fitted", "judged"));
      const floor = {kind: "rule", role: "noise", name: "noise of the currents", axis: "y", at: data.noise_floor};
      return {
        label: "Error after each effect that is ticked",
        height: 260,
        x: {label: "", scale: "band", categories: steps.map(([name]) => name)},
        panels: [{y: {label: "error of the current [%]", scale: "log", percent: true, room: true}, series: [floor, ...lines]}],
      };
    }

    function drawFigures(fit) {
      parts.judged.value.textContent = percent(fit.judged, 4);
      parts.fitted.value.textContent = percent(fit.fitted, 4);
      parts.judged.value.dataset.value = fit.judged;
      parts.fitted.value.dataset.value = fit.fitted;
      parts.judged.value.dataset.figure = "validate";
      parts.fitted.value.dataset.figure = "identify";
      parts.judged.note.textContent = `noise of the currents ${percent(data.noise_floor)}`;
      parts.fitted.note.textContent = `${state.ticks.size ? WorkbenchChoice.requests(data, places, state.ticks).length : "no"} effect${
        WorkbenchChoice.requests(data, places, state.ticks).length === 1 ? "" : "s"
      } ticked`;
      const same = (other) => other.size === state.ticks.size && [...other].every((key) => state.ticks.has(key));
      parts.found.setAttribute("aria-pressed", same(foundTicks));
      parts.nothing.setAttribute("aria-pressed", state.ticks.size === 0);
      table(
        parts.gains,
        ["motor", "drive gain", "off nominal", "fitted", "not fitted"],
        data.motors.map((one, j) => {
          const {gain, fitted, judged} = fit.by[j];
          const off = 100 * (gain / one.nominal - 1);
          return [
            one.joint,
            {text: `${formatNumber(gain, 5)} ${unitOf(one.unit)}`, data: {gain: one.joint, value: gain}},
            `${off > 0 ? "+" : ""}${formatNumber(off, 3)} %`,
            percent(fitted),
            percent(judged),
          ];
        }),
      );
      table(
        parts.parameters,
        ["parameter", "value", "unit"],
        data.parameters.map((one, i) => [one.name, formatNumber(fit.theta[i], 5), unitOf(one.unit)]),
      );
      const requests = WorkbenchChoice.requests(data, places, state.ticks);
      parts.command.textContent = ["bench identify DATASET", ...requests.map((one) => `--with ${one}`)].join(" \\\n  ");
      parts.said.textContent = notes(fit).join(" ");
    }

    /* What keeps the page from being bench identify to the last digit, for what is ticked. */
    function notes(fit) {
      const said = [];
      const names = (test) => [...new Set(fit.effects.filter(test).map((one) => spoken(one.place.effect)))];
      const list = (words) => (words.length > 1 ? `${words.slice(0, -1).join(", ")} and ${words[words.length - 1]}` : words[0]);
      const near = names((one) => one.place.approximate && one.place.kind !== "shape");
      const guessed = names((one) => one.place.approximate && one.place.kind === "shape");
      const whole = [...foundTicks].every((key) => state.ticks.has(key));
      const needed = names((one) => one.place.needed && !whole);
      const short = names((one) => many && one.place.kind === "shape" && !one.place.approximate);
      const outside = names((one) => one.outside);
      const windows = names((one) => one.place.windows && !one.values.some((value) => value.held));
      const held = names((one) => one.values.some((value) => value.held));
      if (near.length) {
        const several = fit.effects.filter((one) => one.place.approximate && one.place.kind !== "shape").length > 1;
        said.push(
          `${titled(list(near))}: linearised about the model that was found; bench identify linearises anew, and may differ in the third digit${
            several ? ", at many places at once by some percent" : ""
          }.`,
        );
      }
      if (guessed.length) {
        said.push(
          `${titled(list(guessed))}: a first guess, since where it acts follows from the model; bench identify may find other values and an error far smaller.`,
        );
      }
      if (short.length) {
        said.push(`${titled(list(short))}: beside so many effects, in few digits; bench identify may differ in the fourth one.`);
      }
      if (needed.length) {
        said.push(
          `${titled(list(needed))}: made of the torque that the model needs; without all effects that were found, bench identify may differ by some percent.`,
        );
      }
      if (outside.length) {
        said.push(`${titled(list(outside))}: a time beyond what this page carries; bench identify may differ.`);
      }
      if (windows.length) {
        said.push(`${titled(list(windows))}: the period is looked for near the two that stood out of the error; bench identify looks everywhere.`);
      }
      if (held.length) said.push(`${titled(list(held))}: held where you put it; bench identify would look for the best value.`);
      if (data.whole) {
        said.push(
          `No recording is kept to judge on. Gains, parameters, curves and the fitted error come from a fit to all rows, as bench identify does it; the error not fitted, the ladder and the errors beside the effects from a fit without ${apart}.`,
        );
      }
      return said;
    }

    function drawCurves(fit) {
      motor.value = state.motor;
      recording.value = state.recording;
      const seen = drawn.recordings[state.recording];
      const {time, low, high, modelled, error} = curves.of(fit, state.recording, state.motor);
      const unit = data.motors[state.motor].unit.split("/")[1] || "A";
      parts.aid.textContent =
        seen.step > 1
          ? `Measured: smallest to largest of every ${seen.step} samples. Modelled and error: one of ${seen.step} (${time.length} of ${seen.rows}); the figures use all.`
          : "Every sample of the fit. Gaps: the joint stands still, which is neither fitted nor judged.";
      const figure = {
        height: 340,
        x: {label: "time [s]"},
        label: `Current of ${data.motors[state.motor].joint} in ${seen.name}`,
        panels: [
          {
            weight: 2,
            y: {label: `current [${unit}]`},
            series: [
              seen.step > 1
                ? {kind: "envelope", role: "measured", name: "measured", x: time, low, high}
                : {kind: "line", role: "measured", name: "measured", x: time, y: low},
              {kind: "line", role: "modelled", name: "modelled", x: time, y: modelled},
            ],
          },
          {y: {label: `error [${unit}]`}, series: [{kind: "line", role: "error", name: "error", x: time, y: error}]},
        ],
      };
      if (curveChart) curveChart.update(figure);
      else curveChart = Charts.create(parts.curves, figure);
    }

    /* All that follows a choice, in parts: ladder, the model itself where it was shown nearly, errors behind ticks. */
    function* all() {
      const nothing = yield* judging.fitted(new Set(), {});
      const steps = yield* ladder(nothing);
      if (!models.has(state.ticks, state.held)) {
        show(yield* models.fitted(state.ticks, state.held));
        if (steps.length > 1) steps[steps.length - 1][1] = ofJudging(shown);
        ladderChart.update(ladderFigure(steps));
      }
      yield;
      const now = ofJudging(shown);
      const largest = Math.max(errorOf(nothing), errorOf(now));
      for (const row of rows) {
        row.after(state, now, yield* lookedAt(switched(row.name), now), errorOf, largest, percent);
        yield;
      }
      section.dataset.ready = "true";
    }

    /* Steps of the ladder, as [name, model], the effect that helps most first. */
    function* ladder(nothing) {
      const steps = [["no effect", nothing]];
      let taken = new Set();
      let left = rows.map((row) => row.name).filter((name) => ownOf(name).some((place) => state.ticks.has(place.key)));
      while (left.length && steps.length <= MOST_STEPS) {
        let best = null;
        for (const name of left) {
          const ticks = new Set([...taken, ...ownOf(name).map((place) => place.key).filter((key) => state.ticks.has(key))]);
          const last = ticks.size === state.ticks.size;
          const fit = last ? ofJudging(shown) : yield* lookedAt(ticks, ofJudging(shown));
          if (!best || errorOf(fit) < errorOf(best.fit)) best = {name, ticks, fit};
          yield;
        }
        taken = best.ticks;
        left = left.filter((name) => name !== best.name);
        steps.push([`+ ${spoken(best.name)}`, best.fit]);
        const ahead = left.slice(0, MOST_STEPS + 1 - steps.length).map(() => ["…", null]);
        if (many && ahead.length) ladderChart.update(ladderFigure([...steps, ...ahead])); // step by step
      }
      if (left.length) steps.push([`+ ${left.length} more`, ofJudging(shown)]);
      ladderChart.update(ladderFigure(steps));
      section.dataset.ladder = (performance.now() - began).toFixed(1);
      return steps;
    }

    function show(fit) {
      shown = fit;
      for (const row of rows) row.show(state, fit);
      drawFigures(fit);
      drawCurves(fit);
    }

    function draw(whole = true) {
      began = performance.now();
      show(many && shown ? models.nearly(state.ticks, state.held, shown) : models.fit(state.ticks, state.held));
      section.dataset.ready = "false";
      section.dataset.reaction = (performance.now() - began).toFixed(1);
      clearTimeout(task);
      if (!whole) {
        task = setTimeout(() => draw(true), 250);
        return;
      }
      const work = all();
      const slice = () => {
        const until = performance.now() + SLICE;
        let done = false;
        while (!done && performance.now() < until) ({done} = work.next());
        if (!done) task = setTimeout(slice, 0);
      };
      afterPaint(slice);
    }

    /* What was shown is painted first; a page that nobody sees is not. */
    function afterPaint(work) {
      const own = (task = setTimeout(() => {
        if (document.hidden) return work();
        requestAnimationFrame(() => {
          if (task === own) task = setTimeout(work, 0);
        });
      }, 0));
    }

    addEventListener("hashchange", () => {
      if (location.hash === WorkbenchChoice.written(drawn, places, state)) return;
      const before = WorkbenchChoice.read(drawn, places, location.hash);
      if (before) state = before;
      else if (location.hash === "") state = WorkbenchChoice.start(drawn, places);
      else return;
      remember();
      draw();
    });
    remember();
    const given = WorkbenchChoice.read(drawn, places, location.hash);
    if (given) state = given;
    draw();
    if (given) section.scrollIntoView();
    return {fit: () => shown};
  }

  window.Workbench = {start};
})();
