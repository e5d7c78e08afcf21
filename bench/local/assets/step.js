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

  /*
  Run what a button asks for; below its row stands how far it is, and then what went wrong, in place of what went wrong
  before. The job once it is over.
  */
  async function run(button, asked) {
    const row = button.closest(".row");
    const [running, show] = progress();
    while (row.nextElementSibling?.matches(".over")) row.nextElementSibling.remove();
    row.after(running);
    button.disabled = true;
    try {
      const job = await Server.run(asked, show);
      if (job.state !== "done") row.after(el("div", {class: "over"}, Dom.outcome(job)));
      return job;
    } finally {
      running.remove();
      button.disabled = false;
    }
  }

  /*
  How far a job is, and a function that shows it: words, a bar, and a button that cancels it. They stay as the job goes
  on, so that the button can be clicked. Its number is in `data-job`.
  */
  function progress() {
    let number = null;
    const words = el("span", {class: "words"}, "starting");
    const click = () => Server.cancel(number).catch(() => undefined);
    const cancel = el("button", {type: "button", class: "small cancel", hidden: true, click}, "Cancel");
    const bar = el("progress", {"aria-label": "starting"});
    const holder = el("div", {class: "running"}, el("div", {class: "row"}, words, cancel), bar);
    const show = (job, before = "", after = "") => {
      const phase = job.phase || (job.state === "waiting" ? "waiting for the command before" : "starting");
      holder.dataset.job = number = job.number;
      words.textContent = `${before}${phase}${job.total ? ` ${job.done} of ${job.total}` : ""}${after}`;
      bar.setAttribute("aria-label", phase);
      if (job.total) Object.assign(bar, {max: job.total, value: job.done});
      else bar.removeAttribute("value");
      cancel.hidden = false;
    };
    return [holder, show];
  }

  return {create, run, progress};
})();
