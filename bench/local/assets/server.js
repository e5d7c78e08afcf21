"use strict";
/* Speaking with the server: questions, files, commands, and what it tells of them. */
const Server = (() => {
  const OVER = ["done", "refused", "cancelled", "ended"];
  const waiting = new Map(); // number of a job -> who waits for it
  const hearing = new Map(); // number of a job -> what hears how far it is
  const own = new Set(); // numbers of the jobs that this page has asked for
  let jobs = [],
    changed = () => undefined; // called with all jobs after every change

  async function answered(response) {
    const found = await response.json();
    if (!response.ok) throw new Error(found.error || response.statusText);
    return found;
  }

  async function ask(path, options = {}) {
    let response;
    try {
      response = await fetch(path, options);
    } catch {
      throw new Error("bench open does not answer any more");
    }
    return answered(response);
  }

  const get = (path) => ask(path);
  const post = (path, content) =>
    ask(path, {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(content)});
  const address = (path) => path.split("/").map(encodeURIComponent).join("/");
  const file = (path) => get(`files/${address(path)}`);
  const look = (name, asked) => post(`api/look/${name}`, asked);

  /*
  What a step is as a command, or what it lacks: a fault that the page knows, or the server's. there: what an import
  finds in its place.
  */
  async function offer(fault, asked) {
    if (fault) return {line: null, fault, there: ""};
    return post("api/command", asked()).then(
      (found) => ({...found, fault: ""}),
      (error) => ({line: null, fault: error.message, there: ""}),
    );
  }

  const upload = (log) => ask(`api/logs/${encodeURIComponent(log.name)}`, {method: "PUT", body: log});

  /* Run a step's command; the job once it is over, however it ended. heard: called with the job as it goes on. */
  async function run(asked, heard = () => undefined) {
    const job = await post("api/run", asked);
    own.add(job.number);
    hearing.set(job.number, heard);
    const known = jobs.find((entry) => entry.number === job.number);
    if (known && OVER.includes(known.state)) return known;
    heard(known || job);
    changed(jobs);
    return new Promise((done) => waiting.set(job.number, done));
  }

  const cancel = (number) => post("api/cancel", {number});

  /* hear: called with all jobs after every change; reachable: with whether the server answers. */
  function listen(hear, reachable) {
    changed = hear;
    const events = new EventSource("events");
    events.addEventListener("message", (event) => {
      jobs = JSON.parse(event.data);
      for (const job of jobs) {
        if (OVER.includes(job.state)) hearing.delete(job.number);
        else if (hearing.has(job.number)) hearing.get(job.number)(job);
        if (!OVER.includes(job.state) || !waiting.has(job.number)) continue;
        waiting.get(job.number)(job);
        waiting.delete(job.number);
      }
      reachable(true);
      changed(jobs);
    });
    events.addEventListener("error", () => reachable(false));
  }

  return {get, file, look, offer, upload, run, cancel, listen, address, own};
})();
