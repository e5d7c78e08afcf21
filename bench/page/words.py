"""Numbers and sentences as they are set on the page."""

import math
import re
from collections.abc import Sequence

from bench.document.numbers import GIVEN, is_poor, percent, value_and_std
from bench.document.numbers import effect_name as spelled
from bench.effects.display_names import named_after
from bench.identification.result import Quantity
from bench.page.parts import Cell

_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def typeset(text: str) -> str:
    """A text with true minus signs, powers of ten in place of "e-05", a space before "%", and names as names."""
    text = re.sub(
        r"(?<=\d)e([+-]?\d+)\b", lambda m: f"·10{str(int(m.group(1))).translate(_SUPERSCRIPT)}", text
    )
    text = re.sub(r"(?<=\d) ?%", "\u00a0%", re.sub(r"(?<![\w.])-(?=\d)", "−", text))
    return named_after(text)


def share(value: float | None, *, signed: bool = False) -> str:
    """A share as a percentage of three digits."""
    return typeset(percent(value, signed=signed))


def short(value: float, digits: int = 4) -> str:
    """A number to some significant digits."""
    return typeset(f"{value:.{digits}g}") if math.isfinite(value) else "–"


def with_std(quantity: Quantity) -> str:
    """A value with its standard deviation, to the digits that this supports; the value alone where it was given."""
    return _pair(quantity.value, quantity.std)


def relative_std(quantity: Quantity) -> Cell:
    """The standard deviation in percent of the value, marked where the value says little."""
    if quantity.std == 0.0:
        return Cell("–")
    return Cell(share(quantity.relative_std), "poor" if is_poor(quantity) else "")


def effect_name(name: str) -> str:
    """An effect's name as it is said."""
    return typeset(spelled(name))


def said_list(names: Sequence[str]) -> str:
    """Names with commas; a dash where there are none."""
    return ", ".join(names) if names else "–"


def plural(count: int, noun: str) -> str:
    """As in "1 recording" and "3 recordings"."""
    return f"{count} {noun}" + ("" if count == 1 else "s")


def _pair(value: float, half: float) -> str:
    first, second = value_and_std(value, half)
    if second == GIVEN:
        return typeset(first)
    if not math.isfinite(half):
        return f"{typeset(first)}, not determined"
    return f"{typeset(first)} ± {typeset(second)}"
