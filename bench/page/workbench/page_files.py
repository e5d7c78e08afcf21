"""The script and the style of the workbench, for insertion into a page."""

from pathlib import Path

ASSETS = Path(__file__).with_name("assets")

SCRIPTS = (
    "numbers.js",
    "equations.js",
    "fit.js",
    "choice.js",
    "curves.js",
    "effects_list.js",
    "skeleton.js",
    "workbench.js",
)


def script() -> str:
    """All scripts as one, which defines `window.Workbench.start(section, data, Charts)`."""
    return "\n".join(_text(name) for name in SCRIPTS)


def style() -> str:
    """The style sheet, which uses the page's colours."""
    return _text("workbench.css")


def _text(name: str) -> str:
    return (ASSETS / name).read_text(encoding="utf-8")
