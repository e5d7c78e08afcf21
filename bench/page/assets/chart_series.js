"use strict";
/* How each kind of series is drawn between two scales. */
const ChartSeries = (() => {
  const {CHARACTER, node, valueAt, known} = ChartBasics;
  const MARGIN = 22; // px right of a plot that a text may reach into

  function path(x, y, count, xs, ys) {
    const parts = [];
    let open = false;
    for (let i = 0; i < count; i++) {
      const value = y[i];
      if (!known(value)) {
        open = false;
        continue;
      }
      parts.push(open ? "L" : "M", xs.at(valueAt(x, i)).toFixed(1), " ", ys.at(value).toFixed(1));
      open = true;
    }
    return parts.join("");
  }

  /* The outline of what lies between two curves, stretch by stretch. */
  function area(x, low, high, xs, ys) {
    const parts = [];
    let start = -1;
    for (let i = 0; i <= low.length; i++) {
      const there = i < low.length && known(low[i]) && known(high[i]);
      if (there && start < 0) start = i;
      if (there || start < 0) continue;
      const points = [];
      for (let k = start; k < i; k++) points.push(`${xs.at(valueAt(x, k)).toFixed(1)} ${ys.at(high[k]).toFixed(1)}`);
      for (let k = i - 1; k >= start; k--)
        points.push(`${xs.at(valueAt(x, k)).toFixed(1)} ${ys.at(low[k]).toFixed(1)}`);
      parts.push(`M${points.join("L")}Z`);
      start = -1;
    }
    return parts.join("");
  }

  function dot(x, y, role, parent, size = 2.6) {
    return node("circle", {cx: x.toFixed(1), cy: y.toFixed(1), r: size, class: `fill ${role}`}, parent);
  }

  function rectangle(x0, x1, y0, y1, kind, parent) {
    const place = {x: Math.min(x0, x1).toFixed(1), y: Math.min(y0, y1).toFixed(1)};
    const size = {width: Math.abs(x1 - x0).toFixed(1), height: Math.abs(y1 - y0).toFixed(1)};
    return node("rect", {...place, ...size, class: kind}, parent);
  }

  /* Lets a mark be picked by mouse and keyboard; `what` is told with the event. */
  function pickable(mark, what) {
    if (!what) return;
    mark.classList.add("pick");
    mark.setAttribute("role", "button");
    mark.setAttribute("tabindex", "0");
    mark.setAttribute("aria-label", Object.values(what).join(", "));
    const tell = () => mark.dispatchEvent(new CustomEvent("pick", {detail: what, bubbles: true}));
    mark.addEventListener("click", tell);
    mark.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      tell();
    });
  }

  const DRAW = {
    line(one, xs, ys, plot, box) {
      const kind = `line ${one.role}${one.dashed ? " dashed" : ""}${one.faint ? " faint" : ""}${one.wide ? " wide" : ""}`;
      node("path", {d: path(one.x, one.y, one.y.length, xs, ys), class: kind}, plot);
      if (one.marker) one.y.forEach((y, i) => known(y) && dot(xs.at(valueAt(one.x, i)), ys.at(y), one.role, plot, 4));
      (one.texts || []).forEach((text, i) => {
        if (!text || !known(one.y[i])) return;
        const at = xs.at(valueAt(one.x, i));
        // a falling line lies left of its points: texts stand right of them, if need be in the margin
        const most = box.right + MARGIN - text.length * CHARACTER;
        const place = {x: Math.min(at + 9, Math.max(at - 4, most)).toFixed(1), y: (ys.at(one.y[i]) - 8).toFixed(1)};
        node("text", {...place, class: "label"}, box.above, text);
      });
    },
    envelope(one, xs, ys, plot) {
      node("path", {d: area(one.x, one.low, one.high, xs, ys), class: `fill ${one.role} edge`}, plot);
    },
    band(one, xs, ys, plot, box) {
      if (typeof one.low === "number")
        rectangle(box.left, box.right, ys.at(one.low), ys.at(one.high), `band ${one.role}`, plot);
      else node("path", {d: area(one.x, one.low, one.high, xs, ys), class: `band ${one.role}`}, plot);
    },
    bins(one, xs, ys, plot) {
      const between = (sign) => one.mean.map((m, i) => (known(m) ? m + sign * one.spread[i] : null));
      if (one.low) {
        const whiskers = one.low.map((low, i) =>
          known(low) ? `M${xs.at(one.x[i]).toFixed(1)} ${ys.at(low).toFixed(1)}V${ys.at(one.high[i]).toFixed(1)}` : "",
        );
        node("path", {d: whiskers.join(""), class: `line ${one.clear ? "" : "thin "}${one.role}`}, plot);
      }
      node("path", {d: area(one.x, between(-1), between(1), xs, ys), class: `band ${one.role}`}, plot);
      if (!one.apart)
        node("path", {d: path(one.x, one.mean, one.mean.length, xs, ys), class: `line ${one.role}`}, plot);
      one.mean.forEach(
        (m, i) =>
          known(m) &&
          pickable(dot(xs.at(one.x[i]), ys.at(m), one.role, plot, one.pick ? 4 : 2.6), one.pick && one.pick[i]),
      );
    },
    points(one, xs, ys, plot) {
      one.y.forEach((y, i) => known(y) && dot(xs.at(valueAt(one.x, i)), ys.at(y), one.role, plot));
    },
    stems(one, xs, ys, plot) {
      const zero = ys.at(0).toFixed(1);
      const all = one.y.map((y, i) =>
        known(y) ? `M${xs.at(valueAt(one.x, i)).toFixed(1)} ${zero}V${ys.at(y).toFixed(1)}` : "",
      );
      node("path", {d: all.join(""), class: `line ${one.role}`}, plot);
      one.y.forEach((y, i) => known(y) && dot(xs.at(valueAt(one.x, i)), ys.at(y), one.role, plot, 2.2));
    },
    histogram(one, xs, ys, plot) {
      const base = ys.low > 0 ? ys.at(ys.low) : ys.at(0);
      one.y.forEach(
        (y, i) =>
          y > 0 &&
          rectangle(xs.at(one.edges[i]), xs.at(one.edges[i + 1]), base, ys.at(y), `fill ${one.role} slab`, plot),
      );
    },
    bars(one, xs, ys, plot, box, place) {
      const base = ys.low > 0 ? ys.at(ys.low) : ys.at(0);
      const width = (0.72 * xs.width) / place.count;
      one.y.forEach((y, i) => {
        if (!known(y)) return;
        const left = xs.at(i) + (place.index - place.count / 2) * width;
        rectangle(left + 1, left + width - 1, base, ys.at(y), `fill ${one.role}`, plot);
      });
    },
    hbars(one, xs, ys, plot) {
      const half = (one.thin ? 0.42 : 0.28) * Math.abs(ys.width);
      one.x.forEach(
        (x, i) =>
          known(x) &&
          rectangle(
            xs.at(0),
            xs.at(x),
            ys.at(i) - half,
            ys.at(i) + half,
            one.thin ? `band ${one.role}` : `fill ${one.role}`,
            plot,
          ),
      );
    },
    intervals(one, xs, ys, plot) {
      one.x.forEach((x, i) => {
        if (!known(x)) return;
        const y = ys.at(one.y[i]) + (one.shift || 0) * Math.abs(ys.width);
        if (one.low && known(one.low[i])) {
          const [a, b] = [xs.at(one.low[i]), xs.at(one.high[i])];
          const ends = b - a > 3 ? `M${a.toFixed(1)} ${y - 4}V${y + 4}M${b.toFixed(1)} ${y - 4}V${y + 4}` : "";
          node("path", {d: `M${a.toFixed(1)} ${y}H${b.toFixed(1)}${ends}`, class: `line ${one.role}`}, plot);
        }
        dot(xs.at(x), y, one.role, plot, 4);
      });
    },
    cells(one, xs, ys, plot) {
      one.share.forEach((share, i) => {
        const [x, y] = [xs.at(one.x[i]), ys.at(one.y[i])];
        const [w, h] = [xs.width / 2 - 1, Math.abs(ys.width) / 2 - 1];
        const cell = rectangle(x - w, x + w, y - h, y + h, `fill ${one.role}`, plot);
        cell.setAttribute("fill-opacity", (0.06 + 0.49 * share).toFixed(2)); // a number is read on every shade
        pickable(cell, one.pick && one.pick[i]);
        node(
          "text",
          {x: x.toFixed(1), y: (y + 4).toFixed(1), class: "label", "text-anchor": "middle"},
          plot,
          one.texts[i],
        );
      });
    },
    rule(one, xs, ys, plot, box) {
      const kind = `line ${one.role}${one.dashed ? " dashed" : ""}`;
      const at = one.axis === "x" ? xs.at(one.at) : ys.at(one.at);
      const d =
        one.axis === "x" ? `M${at.toFixed(1)} ${box.top}V${box.bottom}` : `M${box.left} ${at.toFixed(1)}H${box.right}`;
      node("path", {d, class: kind}, plot);
    },
  };

  return {DRAW, dot, rectangle};
})();
