"""What repeats over a turn of a joint, and not a whole number of times: then nothing fixed to that joint does it."""

import math

from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding
from bench.identification.result import Identification
from bench.identification.tolerances import TOLERANCES

TURN = "1/turn"  # the unit of such a number, of hinges alone


def periods_not_whole(result: Identification) -> list[Finding]:
    """A finding for each effect and joint whose periods a turn are certainly no whole number; names: effect, joint.

    Poles and teeth of a motor that turns with its joint make a whole number of periods a turn, and so does an eccentric
    encoder on the joint; what turns faster or slower, behind a gear or a belt, need not.
    """
    findings = []
    for effect, places in result.effect_parameters.items():
        for place, values in places.items():
            for value in values.values():
                away = abs(value.value - round(value.value))
                if (
                    value.unit == TURN
                    and 0.0 < value.std < math.inf
                    and away > max(TOLERANCES.findings.whole_periods, RULE.certain * value.std)
                ):
                    numbers = {"periods": value.value, "std": value.std}
                    findings.append(Finding(Code.PERIODS_NOT_WHOLE, (effect, place), numbers=numbers))
    return findings
