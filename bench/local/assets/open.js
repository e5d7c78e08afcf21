"use strict";
/* The page: what is opened, what runs, colours, and that every step hears of what the others did. */
(() => {
  const {el} = Dom;
  const app = {
    folder: null,
    dataset: Kept.get("dataset", null),
    described: null,
    fault: null,
    runs: [],
    drawn: null,
    refresh,
    choose,
    latest,
    awaited,
  };
  let numbers = null; // of the commands of other pages that are done

  /* Read the folder again; dataset: the one to show. */
  async function refresh(dataset = app.dataset) {
    app.folder = await Server.get("api/folder");
    const known = app.folder.datasets;
    app.dataset = known.includes(dataset)
      ? dataset
      : known.includes(app.folder.start)
        ? app.folder.start
        : (known[0] ?? null);
    Kept.put("dataset", app.dataset);
    [app.described, app.fault] = [null, null];
    if (app.dataset !== null) {
      await Server.look("dataset", {dataset: app.dataset}).then(
        (found) => (app.described = found),
        (error) => (app.fault = error.message),
      );
    }
    const paths = app.folder.runs.map((run) => run.path);
    const told = paths.length ? await Server.look("runs", {paths}) : [];
    app.runs = told.map((run, i) => ({...run, ...app.folder.runs[i]}));
    render();
  }

  function choose(dataset) {
    return refresh(dataset);
  }

  /* What later steps wait for where no dataset could be described. */
  function awaited() {
    return app.fault ? "This dataset cannot be read: step 1 has the reason." : "First a dataset is needed.";
  }

  /* The newest run of a kind in the results of the dataset that is shown. */
  function latest(kind, fits) {
    const results = app.dataset === "." ? "results" : `${app.dataset}.results`;
    const found = app.runs.filter(
      (run) => !run.fault && run.path.startsWith(`${results}/`) && run.path.endsWith(`-${kind}`) && fits(run),
    );
    return found.sort((a, b) => numberOf(a) - numberOf(b)).pop();
  }

  const numberOf = (run) => Number.parseInt(run.path.split("/").pop(), 10);

  function render() {
    const {name, root, datasets, command} = app.folder;
    document.title = `${name} – parabench`;
    document.getElementById("title").textContent = name;
    const count = datasets.length === 1 ? "1 dataset" : `${datasets.length} datasets`;
    document
      .getElementById("facts")
      .replaceChildren(
        el("span", {}, root),
        " ",
        el("span", {}, count),
        " ",
        el("span", {}, command),
        ...(app.folder.cut ? [" ", el("span", {}, "too many files: only the first were looked at")] : []),
      );
    draw();
  }

  /* Draw every step anew; a section keeps its height meanwhile, so that what is read does not move. */
  function draw() {
    const sections = [...document.querySelectorAll("main > section:not(#recordings)")];
    for (const section of sections) section.style.minHeight = `${section.offsetHeight}px`;
    const drawing = Promise.all([Recordings, Errors, Effects, Results].map((part) => part.render()));
    const drawn = drawing.finally(() => {
      if (app.drawn !== drawn) return; // a later one holds
      for (const section of sections) section.style.minHeight = "";
    });
    app.drawn = drawn;
  }

  const [floating, showFloating] = Step.progress();

  /* Whether a button of this page shows a job, or one that was asked for just now and has no number yet. */
  const atButton = (job) => document.querySelector(`main .running:is([data-job="${job.number}"], :not([data-job]))`);

  /* What runs and is at no button of this page: that of another page, or from before the page was loaded. */
  function showJobs(jobs) {
    const apart = jobs.filter((entry) => ["running", "waiting"].includes(entry.state) && !atButton(entry));
    const job = apart.findLast((entry) => entry.state === "running") || apart.at(-1);
    const holder = document.getElementById("job");
    holder.hidden = !job;
    document.body.classList.toggle("working", Boolean(job));
    if (job) {
      const waiting = apart.filter((entry) => entry.state === "waiting" && entry !== job).length;
      const command = job.line.split(" ").slice(0, 2).join(" ");
      showFloating(job, `${command}: `, waiting ? `, ${waiting} more waiting` : "");
    }
    // what another page has asked for changes this one, too
    const foreign = jobs
      .filter((ended) => ended.state === "done" && ended.step !== "identify" && !Server.own.has(ended.number))
      .map((ended) => ended.number)
      .join();
    if (app.folder && numbers !== null && foreign !== numbers) refresh().catch(unreachable);
    numbers = foreign;
  }

  function unreachable() {
    const banner = document.getElementById("banner");
    banner.hidden = false;
    banner.textContent = `The server does not answer. If it was ended, so was what ran, and nothing half-written is left: start it again with: ${app.folder ? app.folder.command : "bench open"} and open the address that it prints. What was found so far lies in the folder.`;
    document.getElementById("job").hidden = true; // what runs is told again when the server answers
    document.body.classList.remove("working");
  }

  document.getElementById("job").append(floating);
  for (const part of [Recordings, Errors, Effects, Results]) part.start(app);
  Frame.startTheme();
  Frame.startContents();
  app.ready = refresh().catch(unreachable);
  Server.listen(showJobs, (there) => {
    if (there) document.getElementById("banner").hidden = true;
    else unreachable();
  });
})();
