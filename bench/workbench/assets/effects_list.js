"use strict";
/* The list of effects: what is ticked, what each gives, and what the error would become. */
const WorkbenchList = (() => {
  function make(name, kind, parent, text) {
    const found = document.createElement(name);
    if (kind) found.className = kind;
    if (text !== undefined) found.textContent = text;
    if (parent) parent.appendChild(found);
    return found;
  }

  const spoken = (name) =>
    name.replaceAll("_", " ").replace(/\b(coulomb|stribeck)\b/g, (person) => person[0].toUpperCase() + person.slice(1));
  const titled = (name) => spoken(name).replace(/^./, (first) => first.toUpperCase());

  const unitOf = (unit) => (unit === "1" ? "" : unit.replaceAll("*", "·").replace(/\^([23])/g, (_, power) => "²³"[power - 2]));

  function tickOf(parent, kind, text, changed) {
    const label = make("label", kind, parent);
    const input = make("input", "", label);
    input.type = "checkbox";
    const words = make("span", "", label, text);
    input.addEventListener("change", () => changed(input.checked));
    return {input, words};
  }

  function rowOf(parent, effect, own, format, actions) {
    const item = make("li", "bench-effect", parent);
    item.dataset.effect = effect.name;
    const head = make("div", "bench-head", item);
    const {input} = tickOf(head, "bench-tick", titled(effect.name), (on) => actions.effect(effect.name, on));
    input.dataset.effect = effect.name;
    const then = make("span", "bench-then", head);
    const opener = make("button", "bench-open", head);
    opener.type = "button";
    const bar = make("div", "bench-bar", item);
    const fill = make("div", "", bar);
    const details = make("div", "bench-details", item);
    const boxes = new Map();
    if (own.length > 1) {
      const set = make("div", "bench-places", details);
      for (const place of own) {
        const box = tickOf(set, "bench-tick", place.place, (on) => actions.place(place.key, on));
        box.input.dataset.key = place.key;
        boxes.set(place.key, box.input);
      }
    }
    if (effect.why) make("p", "bench-why", details, effect.why);
    const open = (wanted) => {
      details.hidden = !wanted;
      opener.setAttribute("aria-expanded", wanted);
      opener.textContent = wanted ? "▾" : "▸";
      opener.setAttribute("aria-label", `${titled(effect.name)}: ${own.length > 1 ? "where it sits, and " : ""}what diagnose says`);
    };
    open(false);
    opener.addEventListener("click", () => open(details.hidden));
    const values = make("ul", "bench-values", item);
    const sliders = own
      .filter((place) => place.kind !== "linear")
      .map((place) => ({place, slider: WorkbenchSliders.create(place, actions.hold)}));

    function show(state, fit) {
      const ticked = own.filter((place) => state.ticks.has(place.key));
      input.checked = ticked.length > 0;
      input.indeterminate = ticked.length > 0 && ticked.length < own.length;
      item.classList.toggle("ticked", ticked.length > 0);
      for (const [key, box] of boxes) box.checked = state.ticks.has(key);
      values.replaceChildren();
      for (const one of fit.effects.filter((term) => term.place.effect === effect.name)) {
        const line = make("li", "", values);
        if (own.length > 1) make("span", "bench-place", line, one.place.place);
        for (const value of one.values.filter((each) => !each.searched && one.place.kind !== "value")) {
          const text = value.absorbed ? `${value.name} taken up by the model` : `${value.name} ${format(value.value)} ${unitOf(value.unit)}`;
          const shown = make("span", "bench-number", line, text);
          Object.assign(shown.dataset, {key: one.key, parameter: value.name, value: value.value});
        }
        const slider = sliders.find((each) => each.place.key === one.key);
        if (!slider) continue;
        const moved = one.values.find((each) => each.searched) || one.values[0];
        slider.slider.show(moved.value, moved.held === true, format, unitOf);
        Object.assign(slider.slider.holder.dataset, {key: one.key, parameter: moved.name, value: moved.value});
        line.appendChild(slider.slider.holder);
      }
    }

    /* other: the fit with the effect switched over; null while it is not known. largest: error of the longest bar. */
    function after(state, now, other, errorOf, largest, percent) {
      const on = input.checked;
      const error = other ? errorOf(other) : null;
      then.textContent = error === null ? "…" : `${on ? "without" : "with"} ${percent(error)}`;
      then.dataset.value = error === null ? "" : error;
      const better = error !== null && !on && error < 0.97 * errorOf(now);
      item.classList.toggle("better", better);
      fill.style.width = error === null ? "0" : `${Math.min(100, (100 * error) / largest).toFixed(1)}%`;
    }

    return {item, input, show, after, name: effect.name};
  }

  return {make, spoken, titled, unitOf, rowOf};
})();
