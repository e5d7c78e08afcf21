"use strict";
/* Errors as bars: a name, a share in percent, and a bar as long as the share is of the largest. */
const Bars = (() => {
  const {el, percent} = Dom;

  /* steps: name, share and the class of the bar's colour. */
  function create(steps) {
    const most = Math.max(...steps.map(([, share]) => share || 0));
    const made = el("div", {class: "bars"});
    for (const [name, share, kind] of steps) {
      const bar = el("div", {class: `bar ${kind}`});
      bar.style.width = `${(100 * (share || 0)) / (most || 1)}%`;
      made.append(el("span", {}, name), el("span", {class: "number"}, percent(share)), el("div", {}, bar));
    }
    return made;
  }

  return {create};
})();
