"use strict";
/* The mechanism in three dimensions, on a canvas: bars between points, the tool's path coloured by the error. */
window.Machine = (() => {
  const {el, formatPercent} = ChartBasics;
  const TURN = 0.08; // rad for a press of an arrow key

  /* data: what the server says of a recording; the returned `at(time)` shows another moment. */
  function create(holder, data) {
    const frames = data.time.length;
    const middle = data.low.map((low, i) => (low + data.high[i]) / 2);
    const size = data.high.map((high, i) => high - data.low[i]);
    const thin = size.indexOf(Math.min(...size));
    const flat = size[thin] < 0.3 * Math.max(...size); // a planar robot is looked at from the side
    const view = flat
      ? {yaw: thin === 0 ? Math.PI / 2 : 0, pitch: thin === 2 ? Math.PI / 2 : 0}
      : {yaw: 0.6, pitch: 0.45};
    const reach = 0.55 * Math.hypot(...size);
    let frame = 0,
      playing = 0;
    const canvas = el("canvas", {
      class: "machine",
      tabindex: "0",
      role: "img",
      "aria-label": "The mechanism; arrow keys turn it",
      pointerdown: (event) => {
        canvas.setPointerCapture(event.pointerId);
      },
      pointermove: (event) => {
        if (event.buttons) turn(-0.01 * event.movementX, 0.01 * event.movementY);
      },
      keydown: (event) => {
        const turns = {ArrowLeft: [TURN, 0], ArrowRight: [-TURN, 0], ArrowUp: [0, TURN], ArrowDown: [0, -TURN]}[
          event.key
        ];
        if (!turns) return;
        event.preventDefault();
        turn(...turns);
      },
    });
    const slider = el("input", {
      type: "range",
      min: "0",
      max: String(frames - 1),
      value: "0",
      "aria-label": "Time",
      input: () => show(Number(slider.value)),
    });
    const moment = el("output", {class: "name"});
    const play = el("button", {type: "button", class: "small", click: () => (playing ? stop() : start())}, "Play");
    const told =
      data.largest > 0
        ? `Tool path: the stronger its colour, the larger the error, up to ${formatPercent(data.largest)} of the current.`
        : "";
    holder.replaceChildren(
      canvas,
      el("div", {class: "machine-time"}, play, slider, moment),
      el("p", {class: "aid"}, `Drag, or use the arrow keys, to turn it. ${told}`),
    );

    function turn(yaw, pitch) {
      view.yaw += yaw;
      view.pitch = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, view.pitch + pitch));
      draw();
    }

    function start() {
      const began = performance.now() - 1000 * (data.time[frame] - data.time[0]);
      const step = (now) => {
        const time = data.time[0] + (now - began) / 1000;
        if (time >= data.time[frames - 1] || !canvas.isConnected) return stop();
        at(time);
        playing = requestAnimationFrame(step);
        return undefined;
      };
      if (frame === frames - 1) show(0);
      play.textContent = "Pause";
      playing = requestAnimationFrame(step);
    }

    function stop() {
      cancelAnimationFrame(playing);
      playing = 0;
      play.textContent = "Play";
    }

    /* The frame that is nearest to a time, s. */
    function at(time) {
      const step = (data.time[frames - 1] - data.time[0]) / Math.max(frames - 1, 1);
      show(Math.min(frames - 1, Math.max(0, Math.round((time - data.time[0]) / step))));
    }

    function show(number) {
      frame = number;
      slider.value = String(number);
      moment.textContent = `${data.time[number].toFixed(2)} s`;
      draw();
    }

    /* A point of the world on the canvas, with its depth: z is up, and the viewer looks along y. */
    function projected(values, i, scale, width, height) {
      const [x, y, z] = [values[3 * i] - middle[0], values[3 * i + 1] - middle[1], values[3 * i + 2] - middle[2]];
      const [c, s] = [Math.cos(view.yaw), Math.sin(view.yaw)];
      const [right, away] = [c * x + s * y, -s * x + c * y];
      const [cp, sp] = [Math.cos(view.pitch), Math.sin(view.pitch)];
      return [width / 2 + scale * right, height / 2 - scale * (cp * z + sp * away), cp * away - sp * z];
    }

    function draw() {
      const [width, height] = [canvas.clientWidth, canvas.clientHeight];
      const sharp = devicePixelRatio || 1;
      canvas.width = Math.round(width * sharp);
      canvas.height = Math.round(height * sharp);
      const pen = canvas.getContext("2d");
      pen.scale(sharp, sharp);
      pen.lineCap = "round";
      const style = getComputedStyle(document.documentElement);
      const colour = (name) => style.getPropertyValue(`--${name}`).trim();
      const scale = (0.5 * Math.min(width, height)) / (reach || 1);
      const line = (a, b, thick, ink) => {
        [pen.strokeStyle, pen.lineWidth] = [ink, thick];
        pen.beginPath();
        pen.moveTo(a[0], a[1]);
        pen.lineTo(b[0], b[1]);
        pen.stroke();
      };
      if (data.path) {
        for (let i = 1; i < frames; i++) {
          pen.globalAlpha = 0.25 + 0.75 * data.error[i];
          line(
            projected(data.path, i - 1, scale, width, height),
            projected(data.path, i, scale, width, height),
            2,
            colour("error"),
          );
        }
        pen.globalAlpha = 1;
      }
      const bars = data.bars
        .map((bar) => {
          const i = bar.from.length > 3 ? frame : 0;
          const [a, b] = [projected(bar.from, i, scale, width, height), projected(bar.to, i, scale, width, height)];
          return {a, b, thick: Math.max(2, 2 * bar.radius * scale), depth: a[2] + b[2], still: bar.from.length === 3};
        })
        .sort((item, two) => two.depth - item.depth);
      for (const {a, b, thick, still} of bars) {
        line(a, b, thick + 2, colour("ground"));
        line(a, b, thick, still ? colour("noise") : colour("measured"));
      }
      for (const bar of data.simulated) {
        const [a, b] = [bar.from, bar.to].map((ends) => projected(ends, frame, scale, width, height));
        line(a, b, 1.2, colour("modelled"));
      }
      if (data.path) {
        const tool = projected(data.path, frame, scale, width, height);
        pen.fillStyle = colour("modelled");
        pen.beginPath();
        pen.arc(tool[0], tool[1], 5, 0, 2 * Math.PI);
        pen.fill();
      }
    }

    new ResizeObserver(draw).observe(canvas);
    show(0);
    return {at, draw};
  }

  return {create};
})();
