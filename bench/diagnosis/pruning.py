"""Found effects that do not stay: of an impossible sign, or needed no more where the others are converged anew."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import EffectVerdict, LadderStep
from bench.diagnosis.search import MATERIAL
from bench.effects import EffectInstance
from bench.identification.result import Identification

CANCELS = (
    5.0  # times a motor's torque: a spring that balances 80 % of a weight has four times what the motor gives
)
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


def poorer(after: Identification, whole: Identification) -> bool:
    """Whether a model explains recordings that were not fitted clearly worse than another."""
    before, now = whole.error.validate, after.error.validate
    return before is not None and now is not None and now >= (1.0 + MATERIAL) * before


def impossible_but_needed(
    whole: Identification, after: Identification, dropped: Sequence[EffectInstance]
) -> dict[str, Reason]:
    """Effects omitted where their sign is impossible, if the model is clearly poorer for it; and why they go.

    What they did there is needed: a part of theirs that is possible, as Stribeck's law has Coulomb friction in it, or
    something that no effect accounts for. Either is looked for without them. whole: before they were omitted.
    """
    if not poorer(after, whole):
        return {}
    reasons: dict[str, Reason] = {}
    for instance in dropped:
        values = whole.effect_parameters[instance.effect.name][instance.place]
        for parameter in instance.effect.parameters:
            value = values[parameter.name]
            if parameter.positive and value.value < -SHOWS * value.std:
                reasons[instance.effect.name] = Reason(Because.IMPOSSIBLE, (parameter.name, instance.place))
    return reasons


def cancelling_effect(result: Identification, added: Sequence[EffectInstance]) -> dict[str, Reason]:
    """The effect added last, of those with a torque many times all that a motor gives: it cancels another, or the
    model's own parameters, and has no size by itself.
    """
    fitted = [trace for trace in result.recordings if trace.use == "identify"]
    for name in reversed(list(dict.fromkeys(instance.effect.name for instance in added))):
        for j, (joint, gain) in enumerate((joint, result.drive_gains[joint]) for joint in result.joints):
            torque = sum(np.nansum(trace.by_effect[name][:, j] ** 2) for trace in fitted)
            whole = sum(np.sum((gain.value * trace.measured * trace.moving)[:, j] ** 2) for trace in fitted)
            if torque > CANCELS**2 * whole:
                return {name: Reason(Because.CANCELS, (joint,))}
    return {}


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
