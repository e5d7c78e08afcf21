"use strict";
/* A cursor at the pointer, or where another chart has it, and the values there. */
const ChartCursor = (() => {
  const {node, block, formatNumber, valueAt, known} = ChartBasics;

  const unitIn = (label) => ((label || "").match(/\[([^\]]*)\]/) || ["", ""])[1];

  /*
  box: the scale xs and the edges of the plot in units of the drawing, `width` of which it is wide. caption: a line
  above the plot that the values replace; null: they are in a box at the cursor.
  */
  function watch(chart, svg, holder, box, caption) {
    const told = new Map(); // a series that stands in two panels is told once
    for (const panel of chart.figure.panels) {
      for (const entry of panel.series) {
        if (entry.name && !told.has(entry.name) && ["line", "bins", "stems"].includes(entry.kind))
          told.set(entry.name, [entry, panel.y]);
      }
    }
    const readable = [...told.values()];
    if (!readable.length) return;
    const cursor = node("path", {class: "cursor"}, svg);
    const note = caption || block("div", "values", holder);
    const part = caption ? "span" : "p";
    note.hidden = !caption;
    /* The place of the value that is nearest to px. */
    const nearest = (entry, px) => {
      const values = entry.y || entry.mean;
      let best = -1;
      let gap = Infinity;
      for (let i = 0; i < values.length; i++) {
        if (!known(values[i])) continue;
        const distance = Math.abs(box.xs.at(valueAt(entry.x, i)) - px);
        if (distance < gap) [gap, best] = [distance, i];
      }
      return best;
    };
    /* The cursor at px, and the values there; the x that is told of them. */
    const show = (px) => {
      cursor.setAttribute("d", `M${px.toFixed(1)} ${box.top}V${box.bottom}`);
      note.replaceChildren();
      let at = null;
      readable.forEach(([entry, y], k) => {
        const best = nearest(entry, px);
        if (best < 0) return;
        if (k === 0) at = valueAt(entry.x, best);
        if (k === 0) block(part, "", note, `at ${formatNumber(at)} ${unitIn(chart.figure.x.label)}`.trim());
        const value = formatNumber((entry.y || entry.mean)[best] * (y.percent ? 100 : 1), 3);
        block(part, `key ${entry.role}`, note, `${entry.name} ${value} ${unitIn(y.label)}`.trim());
      });
      if (caption) return at;
      note.hidden = false;
      const beside = px / box.width > 0.6 ? px - note.offsetWidth - 12 : px + 12;
      note.style.left = `${Math.max(0, Math.min(beside, box.width - note.offsetWidth))}px`;
      return at;
    };
    chart.unpoint = () => {
      if (caption) caption.textContent = chart.figure.caption;
      else note.hidden = true;
      cursor.setAttribute("d", "");
    };
    chart.point = (value) => {
      const px = box.xs.at(value);
      if (px >= box.left && px <= box.right) show(px);
      else chart.unpoint();
    };
    if (caption) {
      show((box.left + box.right) / 2); // as high as with values, so that the plot does not move
      caption.style.minHeight = `${Math.ceil(caption.getBoundingClientRect().height)}px`;
      chart.unpoint();
    }
    const leave = () => {
      chart.unpoint();
      svg.dispatchEvent(new CustomEvent("uncursor", {bubbles: true}));
    };
    svg.addEventListener("pointerleave", leave);
    svg.addEventListener("pointermove", (event) => {
      const frame = svg.getBoundingClientRect();
      const px = ((event.clientX - frame.left) * box.width) / frame.width;
      if (px < box.left || px > box.right) return leave();
      const at = show(px);
      if (at !== null) svg.dispatchEvent(new CustomEvent("cursor", {detail: at, bubbles: true}));
      return undefined;
    });
  }

  return {watch};
})();
