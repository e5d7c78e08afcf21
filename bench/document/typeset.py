"""Numbers and sentences as they are set: true minus signs, powers of ten, names as names."""

import math
import re

from bench.document.numbers import SUPERSCRIPT, percent
from bench.effects.display_names import named_after, spoken


def typeset(text: str) -> str:
    """A text with true minus signs, powers of ten in place of "e-05", a space before "%", and names as names."""
    text = re.sub(
        r"(?<=\d)e([+-]?\d+)\b", lambda m: f"·10{str(int(m.group(1))).translate(SUPERSCRIPT)}", text
    )
    text = re.sub(r"(?<=\d) ?%", "\u00a0%", re.sub(r"(?<![\w.])-(?=\d)", "−", text))
    return named_after(text)


def share(value: float | None, *, signed: bool = False) -> str:
    """A share as a percentage of three digits."""
    return typeset(percent(value, signed=signed))


def short(value: float, digits: int = 4) -> str:
    """A number to some significant digits."""
    return typeset(f"{value:.{digits}g}") if math.isfinite(value) else "–"


def effect_name(name: str) -> str:
    """An effect's name as it is said."""
    return typeset(spoken(name))
