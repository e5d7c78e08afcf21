"use strict";
/* What frames every page: its colours, which the browser remembers, and the contents, where the section that is read
   is marked. */
const Frame = (() => {
  const THEMES = ["auto", "light", "dark"];

  function remembered() {
    try {
      return localStorage.getItem("theme");
    } catch {
      return null; // a browser may not let a file remember
    }
  }

  function setTheme(theme) {
    const root = document.documentElement;
    if (theme === "auto") delete root.dataset.theme;
    else root.dataset.theme = theme;
    const button = document.getElementById("theme");
    button.textContent = `Colours: ${theme}`;
    button.dataset.now = theme;
    try {
      localStorage.setItem("theme", theme);
    } catch {
      // as above
    }
  }

  function startTheme() {
    const button = document.getElementById("theme");
    const before = remembered();
    setTheme(THEMES.includes(before) ? before : "auto");
    button.addEventListener("click", () => setTheme(THEMES[(THEMES.indexOf(button.dataset.now) + 1) % THEMES.length]));
  }

  function startContents() {
    const links = [...document.querySelectorAll("nav.contents a")];
    const row = document.querySelector("nav.contents"); // on a phone, wider than it shows
    let marked = null;
    let pressed = false;
    const mark = () => {
      if (pressed) return; // a link that moves away under the pointer is not clicked
      let current = links[0];
      for (const link of links) {
        const target = document.getElementById(link.hash.slice(1));
        if (target && target.getBoundingClientRect().top < Math.min(innerHeight / 3, 200)) current = link;
      }
      if (current === marked) return; // the row stays where a reader has moved it
      if (marked) marked.removeAttribute("aria-current");
      marked = current;
      current.setAttribute("aria-current", "true");
      row.scrollLeft = current.offsetLeft - row.clientWidth / 3;
    };
    row.addEventListener("pointerdown", () => (pressed = true));
    for (const end of ["pointerup", "pointercancel"])
      addEventListener(end, () => {
        pressed = false;
        requestAnimationFrame(mark); // after the click
      });
    addEventListener("scroll", mark, {passive: true});
    new ResizeObserver(mark).observe(document.querySelector("main")); // figures drawn later move sections without a scroll
    mark();
  }

  return {startTheme, startContents};
})();
