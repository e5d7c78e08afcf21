"""A number keeps its percent sign on every page, in tables too, and the two ends of an interval stay together."""

import re
from typing import Any

FENCED = re.compile(r"(^ *```.*?^ *```$|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
ENDS = re.compile(r"\[([-−\d.]+), ([-−\d.]+)\](?!\()")
PERCENT = re.compile(r"(?<=\d)[ \n]%(?=[\s|.,;:)*&]|$)")


def on_page_markdown(markdown: str, **_: Any) -> str:
    """What MkDocs calls with the text of a page; what is code stays as it is."""
    parts = FENCED.split(markdown)  # every second part is code
    return "".join(
        part if i % 2 else ENDS.sub("[\\1,\u00a0\\2]", PERCENT.sub("\u00a0%", part))
        for i, part in enumerate(parts)
    )
