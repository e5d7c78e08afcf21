"use strict";
/* The list of effects: what is ticked, what each gives, and what the error would become. */
const WorkbenchList = (() => {
  const MOST_NAMED = 3; // places of an effect

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

  const unitOf = (unit) =>
    unit === "1" ? "" : unit.replaceAll("*", "·").replace(/\^([23])/g, (_, power) => "²³"[power - 2]);

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
    const some = make("span", "bench-some", head);
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
      opener.setAttribute(
        "aria-label",
        `${titled(effect.name)}: ${own.length > 1 ? "where it sits, and " : ""}what diagnose says`,
      );
    };
    open(false);
    opener.addEventListener("click", () => open(details.hidden));
    const values = make("ul", "bench-values", item);

    function show(state, fit) {
      const ticked = own.filter((place) => state.ticks.has(place.key));
      input.checked = ticked.length > 0;
      input.indeterminate = ticked.length > 0 && ticked.length < own.length;
      const where = ticked.length > MOST_NAMED ? "" : `: ${ticked.map((place) => place.place).join(", ")}`;
      some.textContent = input.indeterminate ? `A dash: at ${ticked.length} of ${own.length} places${where}` : "";
      item.classList.toggle("ticked", ticked.length > 0);
      for (const [key, box] of boxes) box.checked = state.ticks.has(key);
      values.replaceChildren();
      for (const fitted of fit.effects.filter((term) => term.place.effect === effect.name)) {
        const line = make("li", "", values);
        if (own.length > 1) make("span", "bench-place", line, fitted.place.place);
        for (const value of fitted.values) {
          const text = value.absorbed
            ? `${value.name} taken up by the model`
            : `${value.name} ${format(value.value)} ${unitOf(value.unit)}`.trim();
          const shown = make(
            "span",
            value.shape ? "bench-number bench-shape" : "bench-number",
            line,
            value.shape ? `${text}, as found` : text,
          );
          Object.assign(shown.dataset, {key: fitted.key, parameter: value.name, value: value.value});
        }
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
