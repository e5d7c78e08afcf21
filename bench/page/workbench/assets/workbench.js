"use strict";
/* The workbench: tick effects, and see errors, gains, ladder and curves of the model that has them. */
(() => {
  const {el} = ChartBasics;
  const {unit: unitOf} = Elements;
  const {spoken, titled, rowOf} = WorkbenchList;
  const {segments, skeleton, table} = WorkbenchSkeleton;
  const SLICE = 14; // ms of solving between two looks at the page
  const MOST_STEPS = 6; // effects of which a ladder is made

  function start(section, data, Charts) {
    const {formatNumber, formatDigits, formatKnown} = ChartBasics;
    const {fit: fitOf, places} = WorkbenchFit.create(data);
    const curves = WorkbenchCurves.create(data);
    const parts = skeleton(section);
    const chosenPlaces = new Map(); // at which places an effect was ticked last
    let state = WorkbenchChoice.start(data, places);
    const foundTicks = new Set(state.ticks);
    const judgedAny = data.motors.some((motor) => motor.judged.squares > 0);
    const errorOf = (fit) => (judgedAny ? fit.judged : fit.fitted);
    const percent = (share, digits = 3) => (share === null ? "–" : `${formatNumber(100 * share, digits)} %`);
    let task = 0;
    let shown = null;
    let pinned = null; // model A: what is ticked, and its fit
    let began = 0;

    const same = (keys, other) => keys.size === other.size && [...keys].every((key) => other.has(key));
    const ownOf = (name) => places.filter((place) => place.effect === name);

    function switched(name) {
      const ticks = new Set(state.ticks);
      const own = ownOf(name).map((place) => place.key);
      if (own.some((key) => ticks.has(key))) own.forEach((key) => ticks.delete(key));
      else (chosenPlaces.get(name) || own).forEach((key) => ticks.add(key));
      return ticks;
    }

    function remember() {
      for (const {name} of data.effects) {
        const ticked = ownOf(name)
          .map((place) => place.key)
          .filter((key) => state.ticks.has(key));
        if (ticked.length) chosenPlaces.set(name, ticked);
      }
    }

    /* A new choice, kept in the address as a step that the back button takes back. */
    function choose(changes) {
      state = {...state, ...changes};
      remember();
      const hash = WorkbenchChoice.written(data, places, state);
      if (location.hash !== hash) location.hash = hash;
      draw();
    }

    const actions = {
      effect: (name) => choose({ticks: switched(name)}),
      place(key, on) {
        const ticks = new Set(state.ticks);
        if (on) ticks.add(key);
        else ticks.delete(key);
        choose({ticks});
      },
    };

    const rows = data.effects
      .filter((effect) => effect.places.length)
      .sort((a, b) => a.rank - b.rank)
      .map((effect) => rowOf(parts.list, effect, ownOf(effect.name), (value) => formatNumber(value, 4), actions));
    const named = (test) =>
      data.effects.filter((effect) => !effect.places.length && test(effect)).map((effect) => spoken(effect.name));
    const unseen = named((effect) => !effect.no_room);
    const crowded = named((effect) => effect.no_room);
    const unlisted = [];
    if (unseen.length) {
      unlisted.push(
        `Not listed, since the model's own parameters take them up and no data of this robot can show them: ${unseen.join(", ")}.`,
      );
    }
    if (crowded.length) {
      unlisted.push(
        `Not listed, since the page would be too large, and diagnose gives them least: ${crowded.join(", ")}; bench identify fits them.`,
      );
    }
    parts.hidden.textContent = unlisted.join(" ");
    parts.found.addEventListener("click", () => choose({ticks: new Set(foundTicks)}));
    parts.nothing.addEventListener("click", () => choose({ticks: new Set()}));
    parts.pin.addEventListener("click", () => {
      pinned = pinned ? null : {ticks: state.ticks, fit: shown};
      show(shown);
    });
    parts.download.addEventListener("click", () => WorkbenchSkeleton.saved(data.model, "model.json"));
    const motor = segments(
      parts.choices,
      "Motor",
      data.motors.map((each) => each.joint),
      (i) => choose({motor: i}),
    );
    const titles = data.recordings.map(
      (recording) => `${recording.name}${recording.use === "identify" ? "" : " (not fitted)"}`,
    );
    const recording = segments(parts.choices, "Recording", titles, (i) => choose({recording: i}));
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
        panels: [
          {y: {label: "error of the current [%]", scale: "log", percent: true, room: true}, series: [floor, ...lines]},
        ],
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
      const requests = WorkbenchChoice.requests(data, places, state.ticks);
      parts.fitted.note.textContent = `${requests.length || "no"} effect${requests.length === 1 ? "" : "s"} ticked`;
      parts.found.setAttribute("aria-pressed", same(foundTicks, state.ticks));
      parts.nothing.setAttribute("aria-pressed", state.ticks.size === 0);
      table(
        parts.gains,
        ["motor", "drive gain", "off nominal", "fitted", "not fitted"],
        data.motors.flatMap((drive, j) => [
          gainRow(drive, fit.by[j], deviationOf(j, state.ticks)),
          ...(pinned ? [gainRow(drive, pinned.fit.by[j], deviationOf(j, pinned.ticks), " of A")] : []),
        ]),
      );
      table(
        parts.parameters,
        ["parameter", "value", "unit"],
        data.parameters.map((parameter, i) => [parameter.name, formatNumber(fit.theta[i], 5), unitOf(parameter.unit)]),
      );
      parts.command.textContent = WorkbenchSkeleton.command(data.command, requests);
      const found = same(foundTicks, state.ticks);
      parts.download.disabled = !found || !data.model;
      parts.file.textContent = found
        ? ""
        : "Diagnose fitted the model of what it found; of another choice the command writes one.";
      parts.pin.setAttribute("aria-pressed", pinned !== null);
      parts.pin.textContent = pinned ? "Let go of A" : "Keep as A";
      parts.pinned.textContent = pinned
        ? `A: ${namesOf(pinned.ticks)}; not fitted ${percent(pinned.fit.judged, 4)}, fitted ${percent(pinned.fit.fitted, 4)}.`
        : "";
      parts.said.textContent = notes(fit).join(" ");
    }

    const namesOf = (ticks) =>
      WorkbenchChoice.requests(data, places, ticks)
        .map((request) => spoken(request).replace(":", " at "))
        .join(", ") || "no effect";

    /* A motor's line of the table; what is read again is that of the model that is ticked. */
    function gainRow(drive, {gain, fitted, judged}, std, whose = "") {
      const off = 100 * (gain / drive.nominal - 1);
      const told = (kind, value, text) =>
        whose ? text : el("span", {[`data-${kind}`]: drive.joint, "data-value": value}, text);
      return [
        `${drive.joint}${whose}`,
        el(
          "span",
          {},
          told("gain", gain, std > 0 ? formatKnown(gain, std) : formatDigits(gain, 5)),
          std > 0 && " ± ",
          std > 0 && told("deviation", std, formatKnown(std, std)),
          ` ${unitOf(drive.unit)}`,
        ),
        `${off > 0 ? "+" : ""}${formatDigits(off, 3)} %`,
        percent(fitted),
        percent(judged),
      ];
    }

    /* Of a gain: known of the models that diagnose fitted, null of others. */
    function deviationOf(number, ticks) {
      const keyOf = ([effect, place]) => (place ? `${effect}:${place}` : effect);
      const known = data.deviations.find(({effects}) => same(new Set(effects.map(keyOf)), ticks));
      return known ? known.gains[number] : null;
    }

    /* What keeps the page from being bench identify to the last digit, for what is ticked. */
    function notes(fit) {
      const said = [];
      const names = (test) => [...new Set(fit.effects.filter(test).map((term) => spoken(term.place.effect)))];
      const list = (words) =>
        words.length > 1 ? `${words.slice(0, -1).join(", ")} and ${words[words.length - 1]}` : words[0];
      const curved = names((term) => term.place.curved);
      if (curved.length && !same(foundTicks, state.ticks)) {
        said.push(
          `${titled(list(curved))}: in the shape, and beside the model, in which diagnose judged ${curved.length > 1 ? "them" : "it"}; bench identify fits that anew, and may find other values and a smaller error.`,
        );
      }
      if (data.held_out) {
        said.push(
          `No recording is kept to judge on: as in the diagnosis, all this is fitted without the last ${(100 * data.held_out).toFixed(0)} % of every recording, and judged on that. bench identify fits all rows.`,
        );
      }
      return said;
    }

    function drawCurves(fit) {
      motor.value = state.motor;
      recording.value = state.recording;
      const seen = data.recordings[state.recording];
      const {time, low, high, modelled, error} = curves.of(fit, state.recording, state.motor);
      const ofA = pinned
        ? [
            {
              kind: "line",
              role: "before",
              name: "error of A",
              x: time,
              y: curves.of(pinned.fit, state.recording, state.motor).error,
            },
          ]
        : [];
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
          {
            y: {label: `error [${unit}]`},
            series: [...ofA, {kind: "line", role: "error", name: "error", x: time, y: error}],
          },
        ],
      };
      if (curveChart) curveChart.update(figure);
      else curveChart = Charts.create(parts.curves, figure);
    }

    /* All that follows a choice, in parts, so that the page stays awake: the ladder, and the errors behind the ticks. */
    function* all() {
      const nothing = fitOf(new Set());
      yield;
      yield* ladder(nothing);
      const largest = Math.max(errorOf(nothing), errorOf(shown));
      for (const row of rows) {
        row.after(state, shown, fitOf(switched(row.name)), errorOf, largest, percent);
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
          const ticks = new Set([
            ...taken,
            ...ownOf(name)
              .map((place) => place.key)
              .filter((key) => state.ticks.has(key)),
          ]);
          const fit = fitOf(ticks);
          if (!best || errorOf(fit) < errorOf(best.fit)) best = {name, ticks, fit};
          yield;
        }
        taken = best.ticks;
        left = left.filter((name) => name !== best.name);
        steps.push([`+ ${spoken(best.name)}`, best.fit]);
      }
      if (left.length) steps.push([`+ ${left.length} more`, shown]);
      const alone = steps.length === 1; // a point is no curve: a sentence says it better
      parts.ladder.hidden = alone;
      parts.alone.hidden = !alone;
      parts.alone.textContent = `No effect is ticked: the model as it is leaves an error of ${percent(errorOf(nothing))}, the noise of the currents alone ${percent(data.noise_floor)}.`;
      if (!alone) ladderChart.update(ladderFigure(steps));
      section.dataset.ladder = (performance.now() - began).toFixed(1);
    }

    function show(fit) {
      shown = fit;
      for (const row of rows) row.show(state, fit);
      drawFigures(fit);
      drawCurves(fit);
    }

    function draw() {
      began = performance.now();
      show(fitOf(state.ticks));
      section.dataset.ready = "false";
      section.dataset.reaction = (performance.now() - began).toFixed(1);
      clearTimeout(task);
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
      if (location.hash === WorkbenchChoice.written(data, places, state)) return;
      const before = WorkbenchChoice.read(data, places, location.hash);
      if (before) state = before;
      else if (location.hash === "") state = WorkbenchChoice.start(data, places);
      else return;
      remember();
      draw();
    });
    remember();
    const given = WorkbenchChoice.read(data, places, location.hash);
    if (given) state = given;
    draw();
    if (given) section.scrollIntoView();
    return {fit: () => shown};
  }

  window.Workbench = {start};
})();
