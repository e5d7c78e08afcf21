"use strict";
/* The page: choices of figures, and print. */
(() => {
  const figures = JSON.parse(document.getElementById("figures").textContent);
  const LOWER = 0.8; // times its height on a screen, of a wide chart on paper
  const PRINTED = {wide: 900, grid: 340}; // px, at which a chart is drawn; paper shows it smaller

  function element(name, kind, parent, text) {
    const made = document.createElement(name);
    if (kind) made.className = kind;
    if (text) made.textContent = text;
    parent.appendChild(made);
    return made;
  }

  /* Notes and charts of one variant; the charts come back. */
  function fill(holder, figure, variant, width) {
    holder.replaceChildren();
    if (variant.notes.length) {
      const list = element("ul", "notes", holder);
      for (const note of variant.notes) {
        const item = element("li", "", list, note.text || note);
        if (!note.to) continue;
        item.append(" ");
        const link = element("a", "", item, note.link);
        link.href = `#${note.to}`;
        link.addEventListener("click", () => choose(document.getElementById(note.to), note.choose));
      }
    }
    const shared = variant.charts.find((chart) => chart.spec.shared);
    if (shared) Charts.legend({...shared.spec, legend: true}, holder);
    const grid = element("div", variant.several ? "charts several" : figure.wide ? "charts" : "charts grid", holder);
    const charts = variant.charts.map((described) => {
      const frame = element("figure", "", grid);
      const title = described.title ? element("figcaption", "", frame) : null;
      if (title) element("h4", "", title, described.title);
      if (title && described.aid) element("p", "aid", title, described.aid);
      const spec = width && figure.wide ? {...described.spec, height: LOWER * described.spec.height} : described.spec;
      const chart = Charts.create(element("div", "chart", frame), spec);
      if (width) chart.draw(width);
      return chart;
    });
    if (variant.several) ChartSeveral.link(charts);
    return charts;
  }

  /* Choose options of a figure in a part of the page; wanted: by the name of their choice. */
  function choose(part, wanted) {
    for (const field of part ? part.querySelectorAll(".choices fieldset") : []) {
      const select = field.querySelector("select");
      const options = [...(select ? select.options : field.querySelectorAll("label"))];
      const found = options.find((option) => option.textContent === wanted[field.querySelector("legend").textContent]);
      if (!found) continue;
      if (select) select.value = found.value;
      else found.querySelector("input").checked = true;
      field.dispatchEvent(new Event("change", {bubbles: true}));
    }
  }

  function startFigure(holder) {
    const figure = figures[holder.dataset.figure];
    const part = holder.closest(".part");
    const inputs = [...part.querySelectorAll(".choices select, .choices fieldset")];
    const state = {figure, holder, charts: [], shown: false, printed: []};
    const chosen = () =>
      inputs
        .filter((field) => field.tagName === "SELECT" || !field.querySelector("select"))
        .map((field) => (field.tagName === "SELECT" ? field.value : field.querySelector(":checked").value));
    state.show = () => {
      state.charts.forEach((chart) => chart.destroy());
      state.charts = fill(holder, figure, ChartSeveral.variant(figure, chosen()));
      state.shown = true;
    };
    state.paper = () => {
      for (const key of figure.printed) {
        const copy = element("div", "printed", part);
        state.printed.push(copy);
        copy.style.display = "block"; // so that it has a width to be drawn at
        const name = figure.choices.map((choice, i) => choice.options[Number(key.split("|")[i])]).join(", ");
        if (name) element("h4", "", copy, name);
        fill(element("div", "", copy), figure, figure.variants[key], figure.wide ? PRINTED.wide : PRINTED.grid);
        copy.style.display = "";
      }
    };
    state.screen = () => {
      state.printed.forEach((copy) => copy.remove());
      state.printed = [];
    };
    part.addEventListener("change", state.show);
    return state;
  }

  function startFigures() {
    const states = new Map(
      [...document.querySelectorAll("[data-figure]")].map((holder) => [holder, startFigure(holder)]),
    );
    const near = new IntersectionObserver(
      (entries) => {
        for (const entry of entries) {
          const state = states.get(entry.target);
          if (entry.isIntersecting && !state.shown) state.show();
        }
      },
      {rootMargin: "600px"},
    );
    for (const holder of states.keys()) near.observe(holder);
    /* A link lands where its section will be only if no figure above it still grows. */
    const settle = () => {
      for (const [holder, state] of states) if (!state.shown && holder.offsetWidth) state.show();
    };
    const aim = (hash) => {
      settle();
      const target = document.getElementById(hash.slice(1));
      const folded = target && target.querySelector(":scope > details");
      if (folded) folded.open = true;
      return target;
    };
    document.addEventListener(
      "click",
      (event) => {
        const link = event.target.closest('a[href^="#"]');
        if (link) aim(link.hash);
      },
      true,
    );
    if (location.hash) {
      const target = aim(location.hash);
      if (target) target.scrollIntoView();
    }
    const closed = [];
    addEventListener("beforeprint", () => {
      for (const folded of document.querySelectorAll("details:not([open])")) {
        closed.push(folded);
        folded.open = true;
      }
      for (const state of states.values()) state.paper();
    });
    addEventListener("afterprint", () => {
      closed.splice(0).forEach((folded) => (folded.open = false));
      for (const state of states.values()) state.screen();
    });
  }

  /* The robot moves with the time cursor of the curves, where they are of its recording. */
  function startMachine(holder) {
    const {data, recording} = figures[holder.dataset.machine];
    const section = holder.closest("section");
    const machine = window.Machine.create(holder, data);
    section.addEventListener("cursor", (event) => {
      const shown = [...section.querySelectorAll("option:checked, label:has(:checked)")];
      if (shown.some((option) => option.textContent === recording)) machine.at(event.detail);
    });
  }

  Frame.startTheme();
  // what has its full height from the beginning comes first: links then land where they should
  for (const holder of document.querySelectorAll("[data-machine]")) startMachine(holder);
  for (const holder of document.querySelectorAll("[data-runs]"))
    window.Runs.start(holder, figures[holder.dataset.runs]);
  startFigures();
  Frame.startContents();
  const workbench = document.getElementById("workbench");
  if (workbench && window.Workbench) {
    window.Workbench.start(workbench, JSON.parse(document.getElementById("workbench-data").textContent), Charts);
  }
})();
