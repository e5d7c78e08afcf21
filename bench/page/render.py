"""A page as one HTML file with style, scripts and data inside; its content-security policy forbids all requests."""

import base64
import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup, escape

from bench.basics.plain_data import finite
from bench.page.parts import Figure, Mechanism, Page, Runs

ASSETS = Path(__file__).with_name("assets")
EVERY_PAGE = (
    "chart_basics.js",
    "elements.js",
    "chart_series.js",
    "chart_zoom.js",
    "chart_cursor.js",
    "chart_several.js",
    "charts.js",
    "frame.js",
)
RUNS, MACHINE = "runs.js", "machine.js"


@dataclass(frozen=True)
class Workbench:
    """The interactive part of a page: data for `script`, which defines `window.Workbench.start(section, data, Charts)`.

    style: additional rules. after: id of the section that it follows.
    """

    data: dict[str, Any]
    script: str
    style: str = ""
    after: str = "ranking"


def asset(name: str, folder: Path = ASSETS) -> str:
    """The text of one of the page's files."""
    return (folder / name).read_text(encoding="utf-8")


def render_page(page: Page, workbench: Workbench | None = None) -> str:
    """The text of the file. Its policy allows only the scripts and the style in it, by their hashes.

    Raises ValueError if one of these contains "</".
    """
    kinds = {type(part) for section in page.sections for part in section.parts}
    more = [name for kind, name in ((Runs, RUNS), (Mechanism, MACHINE)) if kind in kinds]
    added = [workbench.script] if workbench else []
    scripts = [*map(asset, (*EVERY_PAGE, *more)), *added, asset("page.js")]
    style = asset("page.css") + (workbench.style if workbench else "")
    # a script ends at the first end tag, even inside a string: none of ours may contain one
    if any("</" in text for text in (*scripts, style)):
        raise ValueError("a script or style of the page holds '</', which would end it")
    after = [i for i, section in enumerate(page.sections) if workbench and section.id == workbench.after]
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["said"] = _said
    template = environment.from_string(asset("page.html.j2"))
    figures = {
        f"{section.id}-{i}": asdict(part)  # the template gives them these ids
        for section in page.sections
        for i, part in enumerate(section.parts)
        if isinstance(part, Figure | Runs | Mechanism)
    }
    return template.render(
        page=page,
        policy=policy(scripts, style),
        style=Markup(style),
        scripts=[Markup(script) for script in scripts],
        figures=_data(figures),
        workbench=workbench is not None,
        workbench_after=after[0] if after else 0,
        workbench_data=_data(workbench.data) if workbench else "",
    )


def policy(scripts: Sequence[str], style: str) -> str:
    """The content-security policy: nothing from outside, and inside only scripts and style with these hashes."""
    allowed = " ".join(_hash(script) for script in scripts)
    return (
        f"default-src 'none'; script-src {allowed}; style-src {_hash(style)}; img-src data:; base-uri 'none'; "
        "form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _said(sentence: str) -> Markup:
    """A sentence as HTML, with text between backticks, a command or a name to type, as code."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(sentence))))


def _data(value: Any) -> Markup:
    """JSON for a script element: it contains no "<", so that no tag can begin in it."""
    text = json.dumps(finite(value), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029"))
