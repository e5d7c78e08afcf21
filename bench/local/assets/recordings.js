"use strict";
/* The first step: the dataset's recordings, and logs that become some. */
const Recordings = (() => {
  const {el, field, select, radios} = Dom;
  const NEW = "\u0000new";
  /* What holds of one log, and is asked for again of the next. */
  const OF_ONE_LOG = {
    use: "identify",
    load: null,
    mass: "",
    meant: "", // a mass that was asked about and is right
    center: "",
    inertia: "",
    topic: "",
    rate: "",
    skip: 0,
  };
  const form = {
    log: "",
    robot: "",
    dataset: NEW,
    name: null, // of a new dataset, once somebody has typed one
    payload: "load",
    mapped: null,
    ...OF_ONE_LOG,
  };
  let app,
    logs,
    setup,
    notes = [], // what became of files that are no logs
    faults = []; // why logs were not taken

  function start(given) {
    app = given;
    Object.assign(form, Kept.get("form", {}));
    logs = el("div");
    setup = el("div");
    const input = el("input", {
      type: "file",
      id: "files",
      multiple: true,
      accept: ".csv,.tsv,.txt,.dat,.log,.mat,.npz,.parquet,.mcap,.db3,.bag,.xml",
      change: () => take([...input.files]),
    });
    const drop = el(
      "label",
      {
        class: "drop",
        for: "files",
        dragover: (event) => {
          event.preventDefault();
          drop.classList.add("over");
        },
        dragleave: () => drop.classList.remove("over"),
        drop: (event) => {
          event.preventDefault();
          drop.classList.remove("over");
          take([...event.dataTransfer.files]);
        },
      },
      input,
      "Drop logs here, or choose them: CSV and other text, MAT, NPZ, Parquet, ROS bags; of a robot of your own its MJCF (.xml)",
    );
    document
      .getElementById("add-log")
      .replaceChildren(el("div", {class: "panel"}, el("h3", {}, "Add a log"), drop, logs, setup));
  }

  async function take(files) {
    await app.ready;
    const [refused, models, renamed] = [[], [], []];
    for (const file of files) {
      if (file.size > app.folder.largest)
        refused.push(
          `${file.name}: larger than this page takes (${Math.floor(app.folder.largest / 2 ** 20)} MB): put it into the folder by hand, then load this page anew`,
        );
      else {
        notes = [`${file.name} is being copied into the folder (${sized(file.size)}).`];
        render();
        await Server.upload(file).then(
          ({log}) => {
            if (/\.xml$/i.test(log)) models.push(log);
            else form.log = log;
            if (log !== file.name)
              renamed.push(`${file.name} is in the folder as ${log}, a name that every command takes.`);
          },
          (error) => refused.push(error.message),
        );
      }
    }
    await app.refresh();
    await choose(form.log);
    faults = refused;
    notes = [
      ...renamed,
      ...models.map(
        (name) =>
          `${name} is in the folder. A model alone is no robot yet: below, tick its motors and type their gains, and it becomes one.`,
      ),
    ];
    render();
    if (models.length) await Robots.open(models.at(-1));
  }

  function render() {
    document.getElementById("dataset-choice").replaceChildren(Dataset.choice(app));
    document.getElementById("recordings-table").replaceChildren(Dataset.table(app));
    const imported = new Set(
      (app.described ? app.described.recordings : []).map((recording) => recording.name.replace(/\.\w+$/, "")),
    );
    logs.replaceChildren(
      el(
        "ul",
        {class: "logs"},
        ...app.folder.logs.map((log) => {
          const stem = log
            .split("/")
            .pop()
            .replace(/\.\w+$/, "");
          return el(
            "li",
            {},
            el(
              "button",
              {type: "button", "aria-pressed": String(log === form.log), click: () => choose(log)},
              imported.has(stem) ? `${log} ✓` : log,
            ),
          );
        }),
      ),
      ...faults.map((text) => el("p", {class: "fault", role: "alert"}, text)),
      ...notes.map((text) => el("p", {class: "aid", role: "status"}, text)),
    );
    if (setup.children.length) return;
    const {logs: there, robots, datasets} = app.folder; // what was kept may be gone
    if (!there.includes(form.log)) form.log = "";
    if (!(form.robot in robots)) form.robot = "";
    if (!datasets.includes(form.dataset)) form.dataset = NEW;
    draw();
  }

  const keep = () => Kept.put("form", {...form, mapped: null});

  /* Show a log, with its robot if one is chosen. */
  async function choose(log) {
    Object.assign(form, OF_ONE_LOG, {log});
    faults = notes = [];
    form.dataset = app.dataset === null ? NEW : app.dataset;
    if (app.described && !form.robot) form.robot = robotOf(app.described.robot);
    if (!form.robot && app.folder.named_robots.length === 1) [form.robot] = app.folder.named_robots;
    render();
    await draw();
  }

  function robotOf(name) {
    return Object.keys(app.folder.robots).find((path) => path === name || path.split("/").pop() === name) || "";
  }

  const sized = (bytes) => (bytes < 2 ** 20 ? `${Math.ceil(bytes / 2 ** 10)} kB` : `${Math.ceil(bytes / 2 ** 20)} MB`);

  let drawn = 0; // of several that overlap only the last one goes on

  async function draw() {
    const mine = ++drawn;
    keep();
    const own = Robots.create(app, made);
    if (!form.log) return setup.replaceChildren(own);
    const robots = [["", "choose …"], ...Object.entries(app.folder.robots)];
    const robot = field(
      "Robot",
      select(
        robots,
        form.robot,
        (value) => {
          form.robot = value;
          draw();
        },
        {id: "robot"},
      ),
    );
    const checked = el("div");
    const check = el(
      "button",
      {
        type: "button",
        class: "small",
        disabled: !form.robot,
        click: async () => {
          checked.replaceChildren();
          const job = await Step.run(check, {step: "robot", robot: form.robot});
          if (job.state === "done") checked.replaceChildren(Dom.outcome(job));
          checked.querySelector("details")?.setAttribute("open", "");
        },
      },
      "Check the robot",
    );
    checkRobot = () => check.click();
    const parts = [el("h3", {}, form.log), el("div", {class: "row"}, robot, check), checked, own];
    if (!form.robot)
      parts.push(
        el(
          "p",
          {class: "aid"},
          "Which robot is this a log of? A folder with a robot.toml in the opened folder is offered as well, and so is bench open --robot FOLDER; or make one below.",
        ),
      );
    setup.replaceChildren(el("hr"), ...parts);
    if (!form.robot) return undefined;
    if (/\.(csv|tsv|txt|dat|log)$/i.test(form.log))
      setup.append(
        Columns.skipped(form.skip, (lines) => {
          form.skip = lines;
          draw();
        }),
      );
    const reading = el(
      "p",
      {class: "aid", role: "status"},
      `Reading ${form.log} (${sized(app.folder.sizes[form.log])}).`,
    );
    setup.append(reading);
    let look;
    try {
      look = await Server.look("columns", source());
    } catch (error) {
      if (mine === drawn) setup.append(el("p", {class: "fault", role: "alert"}, error.message));
      return undefined;
    } finally {
      reading.remove();
    }
    if (mine !== drawn) return undefined;
    if (look.topics.length > 1)
      setup.append(
        Columns.topics(look.topics, form.topic, (topic) => {
          form.topic = topic;
          draw();
        }),
      );
    if (!look.columns) return undefined;
    const shown = el("div");
    const columns = Columns.create(look, source(), form.rate, (mapped, rate) => {
      Object.assign(form, {mapped, rate});
      command(shown);
    });
    if (look.notes.length) setup.append(el("p", {class: "aid"}, look.notes.join("; ")));
    setup.append(...columns, ...about(shown), shown);
    return command(shown);
  }

  let checkRobot = () => {};

  /* A robot was made: it is the log's, and checked. */
  async function made(folder) {
    await app.refresh();
    form.robot = folder;
    render();
    await draw();
    checkRobot();
  }

  const source = () => ({
    log: form.log,
    robot: form.robot,
    skip_rows: form.skip,
    ...(form.topic ? {topic: form.topic} : {}),
  });

  /* What is not in the log: the payload, the use, the dataset. */
  function about(shown) {
    const changed = () => command(shown);
    const text = (key, properties) => {
      const input = el("input", {
        ...properties,
        value: form[key],
        input: () => {
          form[key] = input.value;
          changed();
        },
      });
      return input;
    };
    const payloads = app.described && form.dataset !== NEW ? Object.keys(app.described.payloads) : [];
    const fresh = el(
      "span",
      {class: "row"},
      field("called", text("payload", {type: "text", id: "payload"})),
      field("weighed, kg", text("mass", {type: "number", min: "0", step: "any", id: "mass"})),
      Payload.more(text),
    );
    const loads = [["", "none"], ...payloads.map((payload) => [payload, payload]), [NEW, "a new one"]];
    if (!loads.some(([value]) => value === form.load)) form.load = null;
    fresh.hidden = form.load !== NEW;
    const on = radios("On the tool", "load", loads, form.load, (value) => {
      form.load = value;
      fresh.hidden = value !== NEW;
      changed();
    });
    const use = radios(
      "Use",
      "use",
      [
        ["identify", "fit it"],
        ["validate", "only compare with it"],
      ],
      form.use,
      (value) => {
        form.use = value;
        changed();
      },
    );
    const called = text("name", {type: "text", id: "name"});
    called.value = nameOfNew();
    const name = field("called", called);
    const into = field(
      "Into",
      select(
        [...app.folder.datasets.map((path) => [path, path === "." ? app.folder.name : path]), [NEW, "a new dataset"]],
        form.dataset,
        (value) => {
          form.dataset = value;
          name.hidden = value !== NEW;
          changed();
        },
        {id: "into"},
      ),
    );
    name.hidden = form.dataset !== NEW;
    return [
      el("div", {class: "row"}, on, fresh),
      el("div", {class: "row"}, use),
      el("div", {class: "row"}, into, name),
    ];
  }

  const nameOfNew = () => form.name ?? app.folder.free;

  function asked() {
    const {lack, ...mapped} = form.mapped;
    const fresh = form.load === NEW;
    return {
      step: "import",
      log: form.log,
      robot: form.robot,
      dataset: form.dataset === NEW ? nameOfNew() : form.dataset,
      fresh: form.dataset === NEW,
      ...mapped,
      accept: [...mapped.accept, ...(fresh && Payload.meant(form) ? ["mass"] : [])],
      use: form.use,
      payload: fresh ? form.payload : form.load,
      payload_mass: fresh && Number(form.mass) > 0 ? Number(form.mass) : null,
      ...(fresh ? Payload.told(form) : {}),
      topic: form.topic || null,
      skip_rows: form.skip,
    };
  }

  let round = 0;
  async function command(holder) {
    const mine = ++round;
    keep();
    const missing = form.mapped.lack
      ? form.mapped.lack
      : form.load === null
        ? "Say what was on the tool."
        : form.load === NEW && !(Number(form.mass) > 0)
          ? "Weigh the payload: its mass gives the gains their scale."
          : form.load === NEW
            ? Payload.fault(form)
            : "";
    const doubt = missing || form.load !== NEW ? null : await Payload.doubt(form, () => command(holder));
    const replacing = () => ({...asked(), replace: true});
    let offered = await Server.offer(missing || (doubt ? "Say what the payload weighs." : ""), asked);
    const {there} = offered;
    if (there) offered = {...(await Server.offer("", replacing)), there};
    if (mine !== round) return;
    const known = there
      ? el(
          "p",
          {class: "aid", id: "there"},
          `${there} is a recording of this dataset already: this log takes its place. The old one is kept until the new one is whole.`,
        )
      : null;
    const imported = async (job, {dataset}) => {
      await app.refresh(dataset);
      const said = `${form.log} is a recording of ${dataset} now.`;
      const done = el("p", {class: "done", role: "status", tabindex: "-1"}, said);
      setup.replaceChildren(done, Dom.outcome(job));
      [form.log, form.name] = ["", null];
      keep();
      render();
      done.focus({preventScroll: true});
      done.scrollIntoView({block: "center"});
    };
    const {line, fault: lacks} = offered;
    const step = {label: there ? `Replace ${there}` : "Import", id: "import", line, lacks, done: imported};
    const shown = Step.create({...step, asked: there ? replacing : asked});
    holder.replaceChildren(...[doubt, known, ...shown].filter((part) => part !== null));
  }

  return {start, render};
})();
