"""Numbers, lists and motors in a sentence."""

import math
from collections.abc import Sequence

from bench.identification.tolerances import TOLERANCES


def in_percent(share: float | None, digits: int = 3) -> str:
    """A share as a percentage of so many digits, all of those before the point; "–" where there is none."""
    if share is None:
        return "–"
    value = 100.0 * share
    return f"{value:.0f} %" if abs(value) >= 10.0**digits else f"{value:.{digits}g} %"


def with_error(value: float, std: float) -> str:
    """A value with its standard error, to two digits of that: 3.3012 ± 0.0015."""
    if not 0.0 < std < math.inf:
        return f"{value:.4g}"
    if std > TOLERANCES.report.largest:
        return f"{value:.4g} ± {std:.2g}"
    digits = 1 - math.floor(math.log10(std))
    std = round(std, digits)
    digits = max(0, 1 - math.floor(math.log10(std)))  # 0.0996 is 0.10
    return f"{value:.{digits}f} ± {std:.{digits}f}"


def and_list(names: Sequence[str]) -> str:
    """Names as in "a, b and c"; "none" where there is no name."""
    return _joined(names, "and")


def or_list(names: Sequence[str]) -> str:
    """Names as in "a, b or c"; "none" where there is no name."""
    return _joined(names, "or")


def _joined(names: Sequence[str], word: str) -> str:
    if len(names) < 2:
        return names[0] if names else "none"
    return f"{', '.join(names[:-1])} {word} {names[-1]}"


def motor_words(joint: str) -> str:
    """A motor by name: "motor left", but "motor_1" as it is."""
    return joint if joint.lower().startswith(("motor", "actuator", "joint")) else f"motor {joint}"
