"""Equations as MathML, made when the site is built: browsers draw it themselves, without a script or a font."""

import html
import re
from typing import Any

from latex2mathml.converter import convert

INLINE = re.compile(r'<span class="arithmatex">\\\((.+?)\\\)</span>', re.DOTALL)
BLOCK = re.compile(r'<div class="arithmatex">\s*\\\[(.+?)\\\]\s*</div>', re.DOTALL)
NUMBER = re.compile(r"\\tag\{([^}]+)\}")


def on_page_content(text: str, **_: Any) -> str:
    """What MkDocs calls with the HTML of a page."""
    text = BLOCK.sub(lambda found: _block(html.unescape(found[1])), text)
    return INLINE.sub(lambda found: convert(html.unescape(found[1])), text)


def _block(latex: str) -> str:
    number = NUMBER.search(latex)
    formula = convert(NUMBER.sub("", latex).strip(), display="block")
    if not number:
        return f'<div class="equation">{formula}</div>'
    return (
        f'<div class="equation" id="eq-{number[1]}">{formula}<span class="number">({number[1]})</span></div>'
    )
