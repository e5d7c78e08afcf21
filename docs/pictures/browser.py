"""Pictures of a page as people see it, to look at after every change: for developers only.

    python docs/pictures/browser.py report.html FOLDER

writes laptop_light.png, laptop_dark.png, phone_light.png, phone_dark.png and print.pdf; `--whole` the whole length of
the page instead of its start. Needs Debian's chromium.
"""

import argparse
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from bench.basics.errors import BenchError

PROGRAMS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
WIDTHS = {"laptop": (1366, 1500), "phone": (390, 844)}


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


def take(report: Path, folder: Path, *, whole: bool) -> list[Path]:
    """Write the pictures into a folder and tell their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with browser() as program:
        for device, (width, height) in WIDTHS.items():
            for dark in (False, True):
                page = scrolled(opened(program, report, width=width, height=height, dark=dark))
                path = folder / f"{device}_{'dark' if dark else 'light'}.png"
                page.screenshot(path=path, full_page=whole)
                written.append(path)
        page = opened(program, report)
        page.pdf(path=folder / "print.pdf", prefer_css_page_size=True)
        written.append(folder / "print.pdf")
    return written


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="python docs/pictures/browser.py", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("report", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--whole", action="store_true", help="the page in its whole length")
    given = parser.parse_args()
    for path in take(given.report, given.folder, whole=given.whole):
        print(path)  # noqa: T201 - a separate program


if __name__ == "__main__":
    main()
