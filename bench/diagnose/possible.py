"""Effects that the data would give an impossible sign, such as a friction that drives."""

from collections.abc import Sequence
from dataclasses import replace

from bench.diagnose.result import EffectVerdict
from bench.effects import EffectInstance
from bench.estimate.result import Identification
from bench.estimate.summary import ROBOT

SHOWS = 3.0  # deviations by which a parameter must differ from zero for its effect to show at a joint


def impossible_effects(result: Identification, added: Sequence[EffectInstance]) -> dict[str, str]:
    """Effects with a clearly negative parameter, that must be positive, wherever they are; and which one it is."""
    found: dict[str, list[str]] = {}
    for one in added:
        values = result.effect_parameters[one.effect.name][one.joint or ROBOT]
        wrong = [
            parameter.name
            for parameter in one.effect.parameters
            if parameter.positive and values[parameter.name].value < -SHOWS * values[parameter.name].std
        ]
        found.setdefault(one.effect.name, []).append(wrong[0] if wrong else "")
    return {name: wrong[0] for name, wrong in found.items() if all(wrong)}


def refused(verdict: EffectVerdict, parameter: str | None) -> EffectVerdict:
    """The verdict on an effect whose parameter of this name came out negative; unchanged where there is none."""
    if parameter is None:
        return verdict
    name = verdict.effect.replace("_", " ")
    why = (
        f"{name.capitalize()} would need a negative {parameter} to explain the data, which is physically impossible: "
        "something else of a like shape is there."
    )
    return replace(verdict, verdict="not supported", actuators=(), alternatives=(), why=why)
