"use strict";
/* A step: a button that runs its command, the command itself, how far it is, and what went wrong when it ran. */
const Step = (() => {
  const {el} = Dom;

  /*
  asked: gives what the server is to do; line: its command, null where something lacks, which `lacks` says; done: called
  with the job that went well and what was asked.
  */
  function create({label, id, asked, line, lacks = "", done}) {
    const start = async () => {
      const wanted = asked();
      const job = await run(button, wanted);
      if (job.state === "done") await done(job, wanted);
    };
    const button = el("button", {type: "button", class: "main", id, disabled: line === null, click: start}, label);
    return [
      el("div", {class: "row"}, button, lacks ? el("span", {class: "name"}, lacks) : null),
      line === null ? "" : Dom.command(line),
    ];
  }

  /* Run what a button asks for; below its row stands how far it is, and then what went wrong. The job once it is over. */
  async function run(button, asked) {
    const row = button.closest(".row");
    const running = el("div", {class: "running"}, ...progress(null));
    if (row.nextElementSibling?.matches(".running")) row.nextElementSibling.remove();
    row.after(running);
    button.disabled = true;
    try {
      const job = await Server.run(asked, (now) => running.replaceChildren(...progress(now)));
      if (job.state === "done") running.remove();
      else running.replaceChildren(Dom.outcome(job));
      return job;
    } finally {
      button.disabled = false;
    }
  }

  /* How far a job is: words and a bar; null: it is not known yet. */
  function progress(job) {
    const phase = job?.phase || (job?.state === "waiting" ? "waiting for the command before" : "starting");
    const steps = job?.total ? ` ${job.done} of ${job.total}` : "";
    const known = job?.total ? {value: job.done, max: job.total} : {};
    return [el("span", {class: "words"}, `${phase}${steps}`), el("progress", {...known, "aria-label": phase})];
  }

  return {create, run, progress};
})();
