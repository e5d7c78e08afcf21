"use strict";
/* Effects to be ticked, with their places: what a diagnosis established first, the others by how their error looks. */
const Choosing = (() => {
  const {el} = Dom;
  const ESTABLISHED = "Established by the diagnosis";
  const NAMED = "Named by the diagnosis"; // by the answer, with what it could be instead
  const POSSIBLE = "Possible by the diagnosis";
  const OUT = ["not supported", "absorbed"]; // verdicts that make an effect neither

  /* effects, groups: of the dataset; ranking: of a diagnosis; missing: what it established; chosen: a set of requests. */
  function create({effects, groups, ranking, missing, chosen, changed}) {
    const verdictOf = (name) => ranking.find((told) => told.effect === name);
    const groupOf = (effect) => {
      const told = verdictOf(effect.name);
      if (missing.includes(effect.name)) return told?.verdict === "missing" ? ESTABLISHED : NAMED;
      return told && !OUT.includes(told.verdict) ? POSSIBLE : effect.group;
    };
    const rank = (effect) => ranking.findIndex((told) => told.effect === effect.name);
    const list = [...effects].sort((a, b) => rank(a) - rank(b) || a.name.localeCompare(b.name));
    const made = [ESTABLISHED, NAMED, POSSIBLE, ...groups].flatMap((title) => {
      const own = list.filter((effect) => groupOf(effect) === title);
      if (!own.length) return [];
      const boxes = own.map((effect) => ({effect, box: boxOf(effect, verdictOf(effect.name), chosen, changed)}));
      const count = el("span", {class: "name"});
      const holder = el("details", {}, el("summary", {}, title, count), ...boxes.map(({box}) => box));
      const wanted = own.some((effect) => [...chosen].some((request) => request.split(":")[0] === effect.name));
      return [{title, boxes, count, holder, wanted}];
    });
    const none = el("p", {class: "aid", hidden: true}, "No effect is called so.");
    const search = el("input", {type: "search", placeholder: "Search effects", "aria-label": "Search effects"});
    const show = () => {
      const text = search.value.trim().toLowerCase();
      for (const {title, boxes, count, holder, wanted} of made) {
        for (const {effect, box} of boxes) box.hidden = !matches(effect, text);
        const shown = boxes.filter(({box}) => !box.hidden).length;
        count.textContent = shown < boxes.length ? ` ${shown} of ${boxes.length}` : ` ${shown}`;
        holder.hidden = !shown;
        holder.open = text !== "" || wanted || [ESTABLISHED, NAMED].includes(title);
      }
      none.hidden = made.some(({holder}) => !holder.hidden);
    };
    search.addEventListener("input", show);
    show();
    return el(
      "div",
      {},
      search,
      el(
        "div",
        {class: "effects", tabindex: "0", role: "group", "aria-label": "Effects"},
        ...made.map(({holder}) => holder),
        none,
      ),
    );
  }

  const matches = (effect, text) =>
    [effect.words, effect.name, effect.group].some((name) => name.toLowerCase().includes(text));

  function boxOf(effect, told, chosen, changed) {
    const legend = el(
      "legend",
      {},
      effect.words,
      told && told.verdict !== "not supported" ? Answer.badge(told.verdict) : null,
    );
    const places = effect.places.length
      ? effect.places.map((place) => [`${effect.name}:${place}`, place])
      : [[effect.name, "the whole robot"]];
    const ticks = places.map(([name, words]) => {
      const tick = () => {
        if (input.checked) chosen.add(name);
        else chosen.delete(name);
        changed();
      };
      const input = el("input", {type: "checkbox", id: name, checked: chosen.has(name), change: tick});
      return el("label", {}, input, words);
    });
    return el("fieldset", {}, legend, el("div", {class: "places"}, ...ticks));
  }

  return {create};
})();
