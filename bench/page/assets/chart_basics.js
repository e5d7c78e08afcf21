"use strict";
/* What charts are made of: nodes of SVG and HTML, numbers as they are printed, values with gaps. */
const ChartBasics = (() => {
  const SPACE = "http://www.w3.org/2000/svg";
  const CHARACTER = 6.7; // px, of a digit in a tick label

  function node(name, attributes, parent, text) {
    const made = document.createElementNS(SPACE, name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
  }

  function block(name, kind, parent, text) {
    const made = document.createElement(name);
    if (kind) made.className = kind;
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
  }

  /* An element: el("p", {class: "aid"}, "text", child, ...); properties that are functions are listened to. */
  function el(name, properties = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (typeof value === "function") made.addEventListener(key, value);
      else if (value === true) made.setAttribute(key, "");
      else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
    }
    made.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
    return made;
  }

  const SUPERSCRIPT = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};

  /* A number to some significant digits, as it is printed: 0.0123, 12 300, 1.2·10⁻⁷. */
  function formatNumber(value, digits = 4) {
    if (value === null || value === undefined || !Number.isFinite(value)) return "–";
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size < 1e-4 || size >= 1e6) {
      const [mantissa, exponent] = value.toExponential(Math.max(digits - 1, 0)).split("e");
      const power = String(Number(exponent)).replace(/./g, (c) => SUPERSCRIPT[c]);
      const short = mantissa.includes(".") ? mantissa.replace(/0+$/, "").replace(/\.$/, "") : mantissa;
      return `${short === "1" ? "" : short === "-1" ? "−" : `${short.replace("-", "−")}·`}10${power}`;
    }
    return String(Number(value.toPrecision(digits))).replace("-", "−");
  }

  /* A number to so many digits, zeros at its end kept, so that those below each other can be compared. */
  function formatDigits(value, digits) {
    const plain = Number.isFinite(value) && Math.abs(value) >= 1e-4 && Math.abs(value) < 10 ** digits;
    return plain ? value.toPrecision(digits).replace("-", "−") : formatNumber(value, digits);
  }

  /* A number to the digits that its standard deviation supports: two of the deviation's. Zero has no sign. */
  function formatKnown(value, std) {
    const text = value.toFixed(decimalsOf(std));
    return Number(text) ? text.replace("-", "−") : text.replace("-", "");
  }

  const decimalsOf = (std) => Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(std))));

  /* A share as a percentage of three digits, so that those below each other can be compared. */
  function formatPercent(share) {
    return Number.isFinite(share) ? `${formatDigits(100 * share, 3)} %` : "–";
  }

  function valueAt(values, i) {
    return Array.isArray(values) || ArrayBuffer.isView(values) ? values[i] : values.start + values.step * i;
  }

  function known(value) {
    return value !== null && value !== undefined && Number.isFinite(value);
  }

  return {CHARACTER, node, block, el, formatNumber, formatDigits, formatKnown, formatPercent, valueAt, known};
})();
