"use strict";
/* What was chosen, kept over a reload of the page: by this window, for the server whose address it has. */
const Kept = (() => {
  const name = (key) => `${location.pathname}#${key}`;

  /* What was put under a key; `otherwise` where nothing was, or where the browser keeps nothing. */
  function get(key, otherwise) {
    try {
      return JSON.parse(sessionStorage.getItem(name(key))) ?? otherwise;
    } catch {
      return otherwise;
    }
  }

  function put(key, value) {
    try {
      sessionStorage.setItem(name(key), JSON.stringify(value));
    } catch {
      // a browser that keeps nothing: the page works all the same until it is reloaded
    }
  }

  return {get, put};
})();
