"""Found effects that do not stay: of an impossible sign, or needed no more where the others are converged anew."""

from collections.abc import Sequence
from dataclasses import replace

from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import EffectVerdict, LadderStep
from bench.diagnosis.search import MATERIAL
from bench.effects import EffectInstance
from bench.identification.result import Identification

SHOWS = 3.0  # deviations by which a parameter must differ from zero for its effect to show at a joint


def impossible_effects(result: Identification, added: Sequence[EffectInstance]) -> dict[str, Reason]:
    """Effects with a clearly negative parameter, that must be positive, wherever they are; and why they go."""
    found: dict[str, list[str]] = {}
    for instance in added:
        values = result.effect_parameters[instance.effect.name][instance.place]
        wrong = [
            parameter.name
            for parameter in instance.effect.parameters
            if parameter.positive and values[parameter.name].value < -SHOWS * values[parameter.name].std
        ]
        found.setdefault(instance.effect.name, []).append(wrong[0] if wrong else "")
    return {name: Reason(Because.IMPOSSIBLE, (wrong[0],)) for name, wrong in found.items() if all(wrong)}


def impossible_but_needed(
    whole: Identification, after: Identification, dropped: Sequence[EffectInstance]
) -> dict[str, Reason]:
    """Effects omitted where their sign is impossible, if the model is clearly poorer for it; and why they go.

    What they did there is needed: a part of theirs that is possible, as Stribeck's law has Coulomb friction in it, or
    something that no effect accounts for. Either is looked for without them. whole: before they were omitted.
    """
    errors = whole.error.validate, after.error.validate
    if errors[0] is None or errors[1] is None or errors[1] < (1.0 + MATERIAL) * errors[0]:
        return {}
    reasons: dict[str, Reason] = {}
    for instance in dropped:
        values = whole.effect_parameters[instance.effect.name][instance.place]
        for parameter in instance.effect.parameters:
            value = values[parameter.name]
            if parameter.positive and value.value < -SHOWS * value.std:
                reasons[instance.effect.name] = Reason(Because.IMPOSSIBLE, (parameter.name, instance.place))
    return reasons


def superfluous_effect(ladder: Sequence[LadderStep]) -> dict[str, Reason]:
    """The effect added last, if the others do as well without it; and why it goes.

    A search compares sets about one model, and every step of the ladder is converged by itself. What made a
    difference there and makes none here only mended how the others were linearised.
    """
    if len(ladder) < 3:  # a single effect competes with nothing at all, which is converged in the search
        return {}
    before, after = ladder[-2:]
    if (
        before.validate is None
        or after.validate is None
        or after.validate < (1.0 - MATERIAL) * before.validate
    ):
        return {}
    (name,) = set(after.effects) - set(before.effects)
    return {name: Reason(Because.NOT_NEEDED)}


def refused(verdict: EffectVerdict, why: Reason | None) -> EffectVerdict:
    """The verdict on an effect that does not stay for this reason; unchanged where there is none."""
    if why is None:
        return verdict
    return replace(verdict, verdict="not supported", actuators=(), alternatives=(), why=why)
