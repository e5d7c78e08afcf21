"use strict";
/* What may be known of a payload beside its mass. */
const Payload = (() => {
  const {el, field} = Dom;
  /* Numbers with commas or blanks between them; null where they are not so many. */
  function numbers(text, count) {
    const found = text
      .split(/[\s,;]+/)
      .filter((number) => number !== "")
      .map(Number);
    return found.length === count && found.every(Number.isFinite) ? found : null;
  }

  /* Fields for it; text: an input for a key of the form. */
  function more(text) {
    return el(
      "details",
      {class: "known"},
      el("summary", {}, "More is known of it"),
      el("p", {class: "aid"}, "What is left empty is estimated."),
      field("centre of mass in the tool frame, m: x, y, z", text("center", {type: "text", id: "center"})),
      field("inertia about it, kg·m²: xx, yy, zz, xy, xz, yz", text("inertia", {type: "text", id: "inertia"})),
    );
  }

  /* What is wrong with what was typed; "" where nothing is. */
  function fault(form) {
    if (form.center.trim() && numbers(form.center, 3) === null) return "The centre of mass has three numbers: x, y, z.";
    if (form.inertia.trim() && numbers(form.inertia, 6) === null)
      return "The inertia has six numbers: xx, yy, zz, xy, xz, yz.";
    return "";
  }

  /* As an import asks for it. */
  function told(form) {
    return {payload_center: numbers(form.center, 3), payload_inertia: numbers(form.inertia, 6)};
  }

  const meant = (form) => form.meant !== "" && form.meant === form.mass;
  const known = new Map();

  /* What is asked of a mass that is hardly one, with its two answers; null where nothing is, or it was answered. */
  async function doubt(form, answered) {
    const mass = Number(form.mass);
    if (!(mass > 0) || meant(form)) return null;
    const key = JSON.stringify([form.robot, mass]);
    if (!known.has(key)) known.set(key, await Server.look("payload", {robot: form.robot, mass}).catch(() => ({})));
    const found = known.get(key);
    if (!found.mass) return null;
    const [heavy, own, less] = [mass, found.own, found.if_grams].map((value) => ChartBasics.formatNumber(value, 4));
    const answer = (id, text, click) => el("button", {type: "button", class: "small", id, click}, text);
    return el(
      "div",
      {class: "row", role: "alert"},
      el(
        "p",
        {class: "said poor"},
        `! ${heavy} kg is far heavier than the robot (${own} kg in its MJCF): is that in grams?`,
      ),
      answer("grams", `It is ${less} kg`, () => {
        document.getElementById("mass").value = form.mass = String(found.if_grams);
        answered();
      }),
      answer("meant", `${heavy} kg is meant`, () => {
        form.meant = form.mass;
        answered();
      }),
    );
  }

  return {more, fault, told, meant, doubt};
})();
