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
    line(series, xs, ys, plot, box) {
      const kind = `line ${series.role}${series.dashed ? " dashed" : ""}${series.faint ? " faint" : ""}${series.wide ? " wide" : ""}`;
      node("path", {d: path(series.x, series.y, series.y.length, xs, ys), class: kind}, plot);
      if (series.marker)
        series.y.forEach((y, i) => known(y) && dot(xs.at(valueAt(series.x, i)), ys.at(y), series.role, plot, 4));
      (series.texts || []).forEach((text, i) => {
        if (!text || !known(series.y[i])) return;
        const at = xs.at(valueAt(series.x, i));
        // a falling line lies left of its points: texts stand right of them, if need be in the margin
        const most = box.right + MARGIN - text.length * CHARACTER;
        const place = {x: Math.min(at + 9, Math.max(at - 4, most)).toFixed(1), y: (ys.at(series.y[i]) - 8).toFixed(1)};
        node("text", {...place, class: "label"}, box.above, text);
      });
    },
    envelope(series, xs, ys, plot) {
      node("path", {d: area(series.x, series.low, series.high, xs, ys), class: `fill ${series.role} edge`}, plot);
    },
    band(series, xs, ys, plot, box) {
      if (typeof series.low === "number")
        rectangle(box.left, box.right, ys.at(series.low), ys.at(series.high), `band ${series.role}`, plot);
      else node("path", {d: area(series.x, series.low, series.high, xs, ys), class: `band ${series.role}`}, plot);
    },
    bins(series, xs, ys, plot) {
      const between = (sign) => series.mean.map((m, i) => (known(m) ? m + sign * series.spread[i] : null));
      if (series.low) {
        const whiskers = series.low.map((low, i) =>
          known(low)
            ? `M${xs.at(series.x[i]).toFixed(1)} ${ys.at(low).toFixed(1)}V${ys.at(series.high[i]).toFixed(1)}`
            : "",
        );
        node("path", {d: whiskers.join(""), class: `line ${series.clear ? "" : "thin "}${series.role}`}, plot);
      }
      node("path", {d: area(series.x, between(-1), between(1), xs, ys), class: `band ${series.role}`}, plot);
      if (!series.apart)
        node("path", {d: path(series.x, series.mean, series.mean.length, xs, ys), class: `line ${series.role}`}, plot);
      series.mean.forEach(
        (m, i) =>
          known(m) &&
          pickable(
            dot(xs.at(series.x[i]), ys.at(m), series.role, plot, series.pick ? 4 : 2.6),
            series.pick && series.pick[i],
          ),
      );
    },
    points(series, xs, ys, plot) {
      series.y.forEach((y, i) => known(y) && dot(xs.at(valueAt(series.x, i)), ys.at(y), series.role, plot));
    },
    stems(series, xs, ys, plot) {
      const zero = ys.at(0).toFixed(1);
      const all = series.y.map((y, i) =>
        known(y) ? `M${xs.at(valueAt(series.x, i)).toFixed(1)} ${zero}V${ys.at(y).toFixed(1)}` : "",
      );
      node("path", {d: all.join(""), class: `line ${series.role}`}, plot);
      series.y.forEach((y, i) => known(y) && dot(xs.at(valueAt(series.x, i)), ys.at(y), series.role, plot, 2.2));
    },
    histogram(series, xs, ys, plot) {
      const base = ys.low > 0 ? ys.at(ys.low) : ys.at(0);
      series.y.forEach(
        (y, i) =>
          y > 0 &&
          rectangle(
            xs.at(series.edges[i]),
            xs.at(series.edges[i + 1]),
            base,
            ys.at(y),
            `fill ${series.role} slab`,
            plot,
          ),
      );
    },
    bars(series, xs, ys, plot, box, place) {
      const base = ys.low > 0 ? ys.at(ys.low) : ys.at(0);
      const width = (0.72 * xs.width) / place.count;
      series.y.forEach((y, i) => {
        if (!known(y)) return;
        const left = xs.at(i) + (place.index - place.count / 2) * width;
        rectangle(left + 1, left + width - 1, base, ys.at(y), `fill ${series.role}`, plot);
      });
    },
    hbars(series, xs, ys, plot) {
      const half = (series.thin ? 0.42 : 0.28) * Math.abs(ys.width);
      series.x.forEach(
        (x, i) =>
          known(x) &&
          rectangle(
            xs.at(0),
            xs.at(x),
            ys.at(i) - half,
            ys.at(i) + half,
            series.thin ? `band ${series.role}` : `fill ${series.role}`,
            plot,
          ),
      );
    },
    intervals(series, xs, ys, plot) {
      series.x.forEach((x, i) => {
        if (!known(x)) return;
        const y = ys.at(series.y[i]) + (series.shift || 0) * Math.abs(ys.width);
        if (series.low && known(series.low[i])) {
          const [a, b] = [xs.at(series.low[i]), xs.at(series.high[i])];
          const ends = b - a > 3 ? `M${a.toFixed(1)} ${y - 4}V${y + 4}M${b.toFixed(1)} ${y - 4}V${y + 4}` : "";
          node("path", {d: `M${a.toFixed(1)} ${y}H${b.toFixed(1)}${ends}`, class: `line ${series.role}`}, plot);
        }
        dot(xs.at(x), y, series.role, plot, 4);
      });
    },
    cells(series, xs, ys, plot) {
      series.share.forEach((share, i) => {
        const [x, y] = [xs.at(series.x[i]), ys.at(series.y[i])];
        const [w, h] = [xs.width / 2 - 1, Math.abs(ys.width) / 2 - 1];
        const cell = rectangle(x - w, x + w, y - h, y + h, `fill ${series.role}`, plot);
        cell.setAttribute("fill-opacity", (0.06 + 0.49 * share).toFixed(2)); // a number is read on every shade
        pickable(cell, series.pick && series.pick[i]);
        node(
          "text",
          {x: x.toFixed(1), y: (y + 4).toFixed(1), class: "label", "text-anchor": "middle"},
          plot,
          series.texts[i],
        );
      });
    },
    rule(series, xs, ys, plot, box) {
      const kind = `line ${series.role}${series.dashed ? " dashed" : ""}`;
      const at = series.axis === "x" ? xs.at(series.at) : ys.at(series.at);
      const d =
        series.axis === "x"
          ? `M${at.toFixed(1)} ${box.top}V${box.bottom}`
          : `M${box.left} ${at.toFixed(1)}H${box.right}`;
      node("path", {d, class: kind}, plot);
    },
  };

  return {DRAW, dot, rectangle};
})();
