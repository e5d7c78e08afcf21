"use strict";
/* A robot of one's own: the robot.toml of an MJCF file, its motors ticked, their gains typed. */
const Robots = (() => {
  const {el, field, select} = Dom;
  const UNITS = [
    ["A", "amperes"],
    ["V", "volts"],
    ["1", "the logs hold torques or forces"],
  ];

  const EMPTY = {model: "", name: "", gains: {}, order: [], unit: "A", tool: "", parts: null};
  const form = {...EMPTY, open: false}; // outlives the panel, which is drawn anew with the step

  let chooseModel = () => {};

  /* Show the panel with a model that was dropped. */
  function open(model) {
    const panel = document.getElementById("own-robot");
    form.open = panel.open = true;
    document.getElementById("mjcf").value = model;
    return chooseModel(model);
  }

  /* app: of the page; made: called with the robot's folder once it is there. */
  function create(app, made) {
    const body = el("div");
    const models = app.folder.mjcfs;
    const chosen = select([["", "choose …"], ...models.map((path) => [path, path])], form.model, choose, {id: "mjcf"});
    const details = el(
      "details",
      {class: "known", id: "own-robot", open: form.open},
      el("summary", {click: () => (form.open = !details.open)}, "A robot of your own, from its MJCF"),
      models.length
        ? el("div", {class: "row"}, field("Model", chosen))
        : el(
            "p",
            {class: "aid"},
            "Drop its .xml above first, with its loops closed by <equality>; meshes go into the folder by hand.",
          ),
      body,
    );

    async function choose(path) {
      Object.assign(form, EMPTY, {model: path, gains: {}, order: []});
      form.name = path
        .split("/")
        .pop()
        .replace(/\.\w+$/, "");
      if (!path) return body.replaceChildren();
      try {
        form.parts = await Server.look("parts", {model: path});
      } catch (error) {
        return body.replaceChildren(el("p", {class: "fault", role: "alert"}, error.message));
      }
      form.tool = form.parts.sites.includes("tool") ? "tool" : "";
      return draw();
    }

    function draw() {
      const shown = el("div");
      const name = el("input", {
        type: "text",
        id: "robot-name",
        value: form.name,
        input: () => {
          form.name = name.value;
          command(shown);
        },
      });
      const sites = [["", "none"], ...form.parts.sites.map((site) => [site, site])];
      body.replaceChildren(
        el(
          "p",
          {class: "aid"},
          "Tick what has a motor, in the order that tables shall have, and type its nominal drive gain from the maker's sheet, gear included; a tenth off does no harm.",
        ),
        el("ul", {class: "motors"}, ...form.parts.motors.map((part) => motor(part, shown))),
        el(
          "div",
          {class: "row"},
          field(
            "Drives command",
            select(
              UNITS,
              form.unit,
              (value) => {
                form.unit = value;
                draw();
              },
              {id: "robot-unit"},
            ),
          ),
          field(
            "Payloads are fixed at the site",
            select(
              sites,
              form.tool,
              (value) => {
                form.tool = value;
                command(shown);
              },
              {id: "robot-tool"},
            ),
          ),
          field("called", name),
        ),
        shown,
      );
      command(shown);
    }

    function motor(part, shown) {
      const gain = el("input", {
        type: "number",
        min: "0",
        step: "any",
        value: form.gains[part.name] ?? "",
        "aria-label": `Nominal drive gain of ${part.name}`,
        disabled: !form.order.includes(part.name),
        input: () => {
          form.gains[part.name] = gain.value;
          command(shown);
        },
      });
      const tick = el("input", {
        type: "checkbox",
        checked: form.order.includes(part.name),
        change: () => {
          form.order = form.order.filter((name) => name !== part.name);
          if (tick.checked) form.order.push(part.name);
          gain.disabled = !tick.checked;
          if (tick.checked) gain.focus();
          command(shown);
        },
      });
      const kind = {
        joint: part.effort === "N" ? "slide" : "hinge",
        tendon: "fixed tendon",
        motor: "actuator with its gear",
      };
      const said = `${kind[part.drives]}${part.actuated && part.drives !== "motor" ? ", has an actuator in the file" : ""}`;
      const unit = form.unit === "1" ? "" : Dom.unit(`${part.effort}/${form.unit}`);
      return el(
        "li",
        {},
        el("label", {}, tick, el("b", {}, part.name), ` ${said}`),
        el("span", {class: "row"}, gain, unit),
      );
    }

    const asked = () => ({
      step: "new robot",
      model: form.model,
      name: form.name,
      motors: form.order.map((name) => [name, Number(form.gains[name])]),
      unit: form.unit,
      tool: form.tool,
    });

    let round = 0;
    async function command(holder) {
      const mine = ++round;
      const missing = !form.order.length
        ? "Tick the motors."
        : form.order.some((name) => !(Number(form.gains[name]) > 0))
          ? "Every motor needs a nominal gain."
          : "";
      const {line, fault} = await Server.offer(missing, asked);
      if (mine !== round) return;
      const done = (job) => {
        Object.assign(form, EMPTY, {open: false});
        return made(job.files.robot);
      };
      holder.replaceChildren(
        ...Step.create({label: "Make the robot", id: "make-robot", asked, line, lacks: fault, done}),
      );
    }

    chooseModel = choose;
    if (form.parts && models.includes(form.model)) draw();
    return details;
  }

  return {create, open};
})();
