"""Typography of numbers and sentences: true minus signs, powers of ten, capitalised names of people."""

import math
import re

from bench.document.numbers import SUPERSCRIPT, percent
from bench.effects.display_names import named_after, spoken


def typeset(text: str) -> str:
    """A text with true minus signs, powers of ten for "e-05", a space before "%", and "Coulomb" capitalised."""
    text = re.sub(
        r"(?<=\d)e([+-]?\d+)\b", lambda m: f"·10{str(int(m.group(1))).translate(SUPERSCRIPT)}", text
    )
    text = re.sub(r"(?<=\d) ?%", "\u00a0%", re.sub(r"(?<![\w.])-(?=\d)", "−", text))
    return named_after(text)


def share(value: float | None, *, signed: bool = False) -> str:
    """A share as a typeset percentage, of about three digits."""
    return typeset(percent(value, signed=signed))


def short(value: float, digits: int = 4) -> str:
    """A number, typeset, to some significant digits; "–" if it is not finite."""
    return typeset(f"{value:.{digits}g}") if math.isfinite(value) else "–"


def effect_name(name: str) -> str:
    """An effect's display name, typeset."""
    return typeset(spoken(name))
