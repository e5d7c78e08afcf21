"""Found effects that do not stay: of an impossible sign, or needed no more where the others are settled anew."""

from collections.abc import Sequence
from dataclasses import replace

from bench.diagnosis.result import EffectVerdict, LadderStep
from bench.diagnosis.search import MATERIAL
from bench.effects import EffectInstance
from bench.effects.display_names import begun
from bench.identification.result import Identification

SHOWS = 3.0  # deviations by which a parameter must differ from zero for its effect to show at a joint


def impossible_effects(result: Identification, added: Sequence[EffectInstance]) -> dict[str, str]:
    """Effects with a clearly negative parameter, that must be positive, wherever they are; and why they go."""
    found: dict[str, list[str]] = {}
    for one in added:
        values = result.effect_parameters[one.effect.name][one.place]
        wrong = [
            parameter.name
            for parameter in one.effect.parameters
            if parameter.positive and values[parameter.name].value < -SHOWS * values[parameter.name].std
        ]
        found.setdefault(one.effect.name, []).append(wrong[0] if wrong else "")
    return {
        name: f"{begun(name)} would need a negative {wrong[0]} to explain the data, which is physically "
        "impossible: something else of a like shape is there."
        for name, wrong in found.items()
        if all(wrong)
    }


def superfluous_effect(ladder: Sequence[LadderStep]) -> dict[str, str]:
    """The effect added last, if the others do as well without it; and why it goes.

    A search compares sets about one model, and every step of the ladder is settled by itself. What made a
    difference there and makes none here only mended how the others were linearised.
    """
    if len(ladder) < 3:  # a single effect stands against nothing at all, which is settled in the search
        return {}
    before, after = ladder[-2:]
    if (
        before.validate is None
        or after.validate is None
        or after.validate < (1.0 - MATERIAL) * before.validate
    ):
        return {}
    (name,) = set(after.effects) - set(before.effects)
    why = f"{begun(name)} is not needed where the other found effects are fitted anew without it."
    return {name: why}


def refused(verdict: EffectVerdict, why: str | None) -> EffectVerdict:
    """The verdict on an effect that does not stay for this reason; unchanged where there is none."""
    if why is None:
        return verdict
    return replace(verdict, verdict="not supported", actuators=(), alternatives=(), why=why)
