"""The page and what belongs to it: its files, and of a report's the style and the charts."""

from functools import cache
from pathlib import Path

from bench.page.render import CHARTS, MACHINE
from bench.page.render import asset as report_asset

ASSETS = Path(__file__).with_name("assets")
SCRIPTS = (
    "dom.js",
    "server.js",
    "step.js",
    "figure.js",
    "columns.js",
    "payload.js",
    "robots.js",
    "dataset.js",
    "gains.js",
    "recordings.js",
    "errors.js",
    "bars.js",
    "answer.js",
    "choosing.js",
    "effects.js",
    "results.js",
    "open.js",
)


@cache
def page_html() -> str:
    """The page; scripts and styles are asked for apart, as its policy wants it."""
    scripts = "\n".join(f'<script src="assets/{name}"></script>' for name in (*CHARTS, MACHINE, *SCRIPTS))
    return (ASSETS / "open.html").read_text(encoding="utf-8").replace("<!-- scripts -->", scripts)


def asset(name: str) -> tuple[str, str] | None:
    """A file that belongs to the page, with its kind; None for any other name."""
    if name in (*CHARTS, MACHINE):
        return report_asset(name), "text/javascript"
    if name == "page.css":
        return report_asset(name), "text/css"
    if name == "open.css":
        return (ASSETS / name).read_text(encoding="utf-8"), "text/css"
    if name in SCRIPTS:
        return (ASSETS / name).read_text(encoding="utf-8"), "text/javascript"
    return None
