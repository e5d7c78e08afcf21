"use strict";
/* The list of effects: what is ticked, what each gives, and what the error would become. */
const WorkbenchList = (() => {
  const MOST_NAMED = 3; // places of an effect

  const {el} = ChartBasics;

  const spoken = (name) =>
    name.replaceAll("_", " ").replace(/\b(coulomb|stribeck)\b/g, (person) => person[0].toUpperCase() + person.slice(1));
  const titled = (name) => spoken(name).replace(/^./, (first) => first.toUpperCase());

  /* A box to be ticked, and its label. */
  function tickOf(text, data, changed) {
    const input = el("input", {type: "checkbox", ...data, change: () => changed(input.checked)});
    return {input, label: el("label", {class: "bench-tick"}, input, el("span", {}, text))};
  }

  function rowOf(parent, effect, own, format, actions) {
    const name = {"data-effect": effect.name};
    const {input, label} = tickOf(titled(effect.name), name, (on) => actions.effect(effect.name, on));
    const [some, then] = [el("span", {class: "bench-some"}), el("span", {class: "bench-then"})];
    const fill = el("div");
    const boxes = new Map();
    const details = el("div", {class: "bench-details"});
    if (own.length > 1) {
      const ticks = own.map(({key, place}) => {
        const box = tickOf(place, {"data-key": key}, (on) => actions.place(key, on));
        boxes.set(key, box.input);
        return box.label;
      });
      details.append(el("div", {class: "bench-places"}, ...ticks));
    }
    if (effect.why) details.append(el("p", {class: "bench-why"}, effect.why));
    const told = `${titled(effect.name)}: ${own.length > 1 ? "where it sits, and " : ""}what diagnose says`;
    const opener = el("button", {
      type: "button",
      class: "bench-open",
      "aria-label": told,
      click: () => open(details.hidden),
    });
    const open = (wanted) => {
      details.hidden = !wanted;
      opener.setAttribute("aria-expanded", wanted);
      opener.textContent = wanted ? "▾" : "▸";
    };
    open(false);
    const values = el("ul", {class: "bench-values"});
    const head = el("div", {class: "bench-head"}, label, some, then, opener);
    const bar = el("div", {class: "bench-bar"}, fill);
    const item = el("li", {class: "bench-effect", ...name}, head, bar, details, values);
    parent.append(item);

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
        const place = own.length > 1 && el("span", {class: "bench-place"}, fitted.place.place);
        values.append(el("li", {}, place, ...fitted.values.map((value) => numberOf(fitted.key, value))));
      }
    }

    function numberOf(key, value) {
      const number = `${value.name} ${format(value.value)} ${Elements.unit(value.unit)}`.trim();
      const text = value.absorbed ? `${value.name} taken up by the model` : number;
      const kind = value.shape ? "bench-number bench-shape" : "bench-number";
      const data = {"data-key": key, "data-parameter": value.name, "data-value": value.value};
      return el("span", {class: kind, ...data}, value.shape ? `${text}, as found` : text);
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

  return {spoken, titled, rowOf};
})();
