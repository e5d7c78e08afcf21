"use strict";
/* A slider over all values of an effect's shape, or time, that the page can solve for. */
const WorkbenchSliders = (() => {
  const STEPS = 240;

  /* The slider's stops: values in rising order, evenly spaced as each piece is interpolated. */
  function stopsOf(place) {
    const pieces = place.pieces.filter((piece) => piece.branch === 0); // the branches have like ranges
    const share = Math.max(20, Math.round(STEPS / pieces.length));
    const stops = [];
    for (const piece of pieces) {
      const [first, last] = [piece.at[0], piece.at[piece.at.length - 1]];
      const count = piece.at.length === 1 ? 1 : share + 1;
      for (let i = 0; i < count; i++) {
        const at = count === 1 ? first : first + ((last - first) * i) / (count - 1);
        stops.push(piece.logarithmic ? Math.exp(at) : at);
      }
    }
    stops.sort((a, b) => a - b);
    return stops.filter((value, i) => i === 0 || value > stops[i - 1]);
  }

  function create(place, changed) {
    const stops = stopsOf(place);
    const what = place.kind === "shape" ? place.shape : place.parameters[0];
    const holder = document.createElement("div");
    holder.className = "bench-slider";
    const label = document.createElement("label");
    const text = document.createElement("span");
    const input = document.createElement("input");
    Object.assign(input, {type: "range", min: 0, max: stops.length - 1, step: 1});
    const back = document.createElement("button");
    Object.assign(back, {type: "button", textContent: "as found"});
    back.setAttribute("aria-label", `${what.name}${place.place ? ` at ${place.place}` : ""}: back to the value that the fit finds`);
    label.append(text, input);
    holder.append(label, back);
    input.addEventListener("input", () => changed(place.key, stops[Number(input.value)], false));
    input.addEventListener("change", () => changed(place.key, stops[Number(input.value)], true));
    back.addEventListener("click", () => {
      changed(place.key, undefined, true);
      input.focus();
    });

    function show(value, held, format, unitOf) {
      let best = 0;
      stops.forEach((stop, i) => {
        if (Math.abs(stop - value) < Math.abs(stops[best] - value)) best = i;
      });
      input.value = best;
      const words = `${what.name} ${format(value)} ${unitOf(what.unit)}`.trim();
      input.setAttribute("aria-valuetext", words);
      text.textContent = held ? `${words}, held` : `${words}, found`;
      back.hidden = !held;
      holder.classList.toggle("held", held);
    }

    return {holder, show};
  }

  return {create};
})();
