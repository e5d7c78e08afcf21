"""Numbers and motors in a sentence."""

import math

from bench.identification.tolerances import TOLERANCES


def with_error(value: float, std: float) -> str:
    """A value with its standard error, to two digits of that: 3.3012 ± 0.0015."""
    if not 0.0 < std < math.inf:
        return f"{value:.4g}"
    if std > TOLERANCES.report.largest:
        return f"{value:.4g} ± {std:.2g}"
    digits = 1 - math.floor(math.log10(std))
    std = round(std, digits)
    digits = max(0, 1 - math.floor(math.log10(std)))  # 0.0996 is 0.10
    return f"{value:z.{digits}f} ± {std:.{digits}f}"


def motor_words(joint: str) -> str:
    """A motor by name: "motor left", but "motor_1" as it is."""
    return joint if joint.lower().startswith(("motor", "actuator", "joint")) else f"motor {joint}"
