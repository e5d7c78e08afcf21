"""A browser without a window that looks at a page as a user would: for tests and pictures."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from bench.basics.errors import BenchError

PROGRAMS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def browser_program() -> str | None:
    """The path of Chromium on this machine; None where there is none."""
    return next((program for name in PROGRAMS if (program := shutil.which(name))), None)


@contextmanager
def browser() -> Iterator[Browser]:
    """Chromium, without a window and without a network. Raises BenchError where there is none."""
    program = browser_program()
    if program is None:
        raise BenchError("no Chromium here: install it (Debian: apt-get install chromium)")
    with sync_playwright() as playwright:
        # a container's root cannot have Chromium's sandbox; the pages are written by this program
        launched = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        try:
            yield launched
        finally:
            launched.close()


def blank(browser: Browser, *, width: int = 1366, height: int = 900, dark: bool = False) -> Page:
    """A window with nothing in it yet, so that what a page says and asks for can be heard from its start."""
    return browser.new_page(
        viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light"
    )


def opened(browser: Browser, path: Path, *, width: int = 1366, height: int = 900, dark: bool = False) -> Page:
    """A page from its file, at a width in px, in light or dark colours."""
    page = blank(browser, width=width, height=height, dark=dark)
    page.goto(path.resolve().as_uri())
    return page


def scrolled(page: Page) -> Page:
    """The same page after all its figures came into view, at its top again."""
    at, step = 0, (page.viewport_size or {"height": 500})["height"]
    while at < int(page.evaluate("document.documentElement.scrollHeight")):  # it grows as figures are drawn
        page.evaluate(f"scrollTo({{top: {at}, behavior: 'instant'}})")
        page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        at += step
    page.evaluate("scrollTo({top: 0, behavior: 'instant'})")
    return page
