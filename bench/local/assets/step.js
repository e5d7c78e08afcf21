"use strict";
/* A step: a button that runs its command, the command itself, and what went wrong when it ran. */
const Step = (() => {
  const {el} = Dom;

  /*
  asked: gives what the server is to do; line: its command, null where something lacks, which `lacks` says; done: called
  with the job that went well and what was asked.
  */
  function create({label, id, asked, line, lacks = "", done}) {
    const said = el("div");
    const button = el(
      "button",
      {
        type: "button",
        class: "main",
        id,
        disabled: line === null,
        click: async () => {
          button.disabled = true;
          const wanted = asked();
          const job = await Server.run(wanted);
          button.disabled = false;
          said.replaceChildren(job.state === "done" ? "" : Dom.outcome(job));
          if (job.state === "done") await done(job, wanted);
        },
      },
      label,
    );
    return [
      el("div", {class: "row"}, button, lacks ? el("span", {class: "name"}, lacks) : null),
      line === null ? "" : Dom.command(line),
      said,
    ];
  }

  return {create};
})();
