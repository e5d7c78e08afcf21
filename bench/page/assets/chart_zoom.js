"use strict";
/* Curves enlarged along x: dragged across, and whole again by a button or a double click. */
const ChartZoom = (() => {
  const {node, block} = ChartBasics;
  const LEAST = 8; // px that are dragged, not clicked
  const CURVE = 20; // samples: fewer are points, which one sees as they are

  const long = (entry) => (entry.y || entry.low || []).length > CURVE && !entry.texts;

  /* Whether a figure has curves over an axis that can be cut. */
  function possible(figure) {
    const series = figure.panels.flatMap((panel) => panel.series);
    return (
      figure.x.scale !== "band" && series.some((entry) => ["line", "envelope"].includes(entry.kind) && long(entry))
    );
  }

  /* The figure as it is to be drawn: with the stretch of x that was chosen, where its curves have one. */
  function shown(chart) {
    const {figure, stretch} = chart;
    return stretch && possible(figure) ? {...figure, x: {...figure.x, domain: stretch}} : figure;
  }

  /* box: the scale xs and the edges of the plot in units of the drawing, `width` of which it is wide. */
  function watch(chart, svg, holder, box) {
    const {xs, left, right, top, bottom, width} = box;
    const valueAt = (px) => {
      const share = (px - left) / (right - left);
      return chart.figure.x.scale === "log"
        ? xs.low * (xs.high / xs.low) ** share
        : xs.low + share * (xs.high - xs.low);
    };
    const place = (event) => {
      const frame = svg.getBoundingClientRect();
      const px = ((event.clientX - frame.left) * width) / frame.width;
      return Math.min(Math.max(px, left), right);
    };
    const to = (stretch) => {
      chart.stretch = stretch;
      chart.draw();
      chart.element.dispatchEvent(new CustomEvent("stretch", {detail: stretch, bubbles: true}));
    };
    const mark = node("rect", {class: "stretch", y: top, height: bottom - top, width: 0}, svg);
    let from = null;
    svg.classList.add("curves");
    svg.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      from = place(event);
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointermove", (event) => {
      if (from === null) return;
      const at = place(event);
      mark.setAttribute("x", Math.min(from, at).toFixed(1));
      mark.setAttribute("width", Math.abs(at - from).toFixed(1));
    });
    svg.addEventListener("pointercancel", () => {
      from = null;
      mark.setAttribute("width", 0);
    });
    svg.addEventListener("pointerup", (event) => {
      if (from === null) return;
      const ends = [from, place(event)].sort((a, b) => a - b);
      from = null;
      if (ends[1] - ends[0] >= LEAST) to(ends.map(valueAt));
      else mark.setAttribute("width", 0);
    });
    svg.addEventListener("dblclick", () => to(null));
    if (!chart.stretch) return;
    const whole = block("button", "small whole", holder, "Show all of it");
    whole.type = "button";
    whole.addEventListener("click", () => to(null));
  }

  return {possible, shown, watch};
})();
