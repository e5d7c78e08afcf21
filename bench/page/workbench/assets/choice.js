"use strict";
/* What is chosen, and how it stands in the address: #workbench?with=coulomb_friction:left&motor=left ... */
const WorkbenchChoice = (() => {
  const NAME = "#workbench";

  /* Effects in words of `--with`: the effect's name where it is ticked wherever it can sit. */
  function requests(data, places, ticks) {
    const found = [];
    for (const effect of data.effects) {
      const own = places.filter((place) => place.effect === effect.name);
      const ticked = own.filter((place) => ticks.has(place.key));
      if (!ticked.length) continue;
      if (ticked.length === own.length) found.push(effect.name);
      else found.push(...ticked.map((place) => place.key));
    }
    return found;
  }

  function keysOf(places, names) {
    const wanted = new Set(names);
    return new Set(
      places.filter((place) => wanted.has(place.key) || wanted.has(place.effect)).map((place) => place.key),
    );
  }

  function start(data, places) {
    const found = data.found.map(([effect, place]) => (place ? `${effect}:${place}` : effect));
    return {ticks: keysOf(places, found), motor: 0, recording: 0};
  }

  function written(data, places, state) {
    const parts = [["with", requests(data, places, state.ticks).join(",") || "none"]];
    parts.push(["motor", data.motors[state.motor].joint], ["recording", data.recordings[state.recording].name]);
    const safe = (text) => encodeURIComponent(text).replace(/%(2C|3A|40)/g, decodeURIComponent);
    return `${NAME}?${parts.map(([name, value]) => `${name}=${safe(value)}`).join("&")}`;
  }

  /* The choice that an address holds; null where it is about something else. */
  function read(data, places, hash) {
    const [name, query] = [hash.slice(0, hash.indexOf("?")), hash.slice(hash.indexOf("?") + 1)];
    if (!hash.includes("?") || name !== NAME) return null;
    const given = new Map();
    for (const part of query.split("&")) {
      const at = part.indexOf("=");
      try {
        given.set(part.slice(0, at), decodeURIComponent(part.slice(at + 1)));
      } catch {
        return null; // not an address of ours
      }
    }
    const state = start(data, places);
    if (given.has("with")) state.ticks = keysOf(places, given.get("with").split(","));
    state.motor = Math.max(
      data.motors.findIndex((motor) => motor.joint === given.get("motor")),
      0,
    );
    state.recording = Math.max(
      data.recordings.findIndex((recording) => recording.name === given.get("recording")),
      0,
    );
    return state;
  }

  return {requests, start, written, read};
})();
