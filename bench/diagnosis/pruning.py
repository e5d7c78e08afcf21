"""Identified effects that do not stay: of an impossible sign, or needed no more where the others are converged anew."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from bench.diagnosis.evidence import Samples
from bench.diagnosis.ladder import Fits
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import EffectVerdict
from bench.diagnosis.significance import wrong_signs
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.result import Identification


def impossible_effects(result: Identification, added: Sequence[EffectInstance]) -> dict[str, Reason]:
    """Effects with a clearly negative parameter, that must be positive, wherever they are; and why they go."""
    by_name: dict[str, list[list[str]]] = {}
    for instance in added:
        by_name.setdefault(instance.name, []).append(wrong_signs(result, instance))
    return {name: Reason(Because.IMPOSSIBLE, (wrong[0][0],)) for name, wrong in by_name.items() if all(wrong)}


def impossible_but_needed(whole: Identification, dropped: Sequence[EffectInstance]) -> dict[str, Reason]:
    """Effects omitted where their sign is impossible, if the model is less probable for it; and why they go.

    What they did there is needed: a part of theirs that is possible, as Stribeck's law has Coulomb friction in it, or
    something that no effect accounts for. Either is looked for without them. whole: before they were omitted.
    """
    reasons: dict[str, Reason] = {}
    for instance in dropped:
        if wrong := wrong_signs(whole, instance):
            reasons[instance.name] = Reason(Because.IMPOSSIBLE, (wrong[-1], instance.place))
    return reasons


def cancelling_effect(result: Identification, added: Sequence[EffectInstance]) -> dict[str, Reason]:
    """The effect added last, of those with a torque many times all that a motor gives, or which cancels that of
    another: it has no size by itself.
    """
    by_motor = {instance.name: instance.effect.by_motor for instance in added}
    for j, (joint, gain) in enumerate((joint, result.drive_gains[joint]) for joint in result.joints):
        given, torques = _torques_at(result, j, gain.value, list(by_motor))
        for name, torque in reversed(torques.items()):
            if _rms(torque) > (RULE.much if by_motor[name] else RULE.cancels) * given:
                return {name: Reason(Because.CANCELS, (joint,))}
        for first, second in combinations(torques, 2):
            smaller = min(_rms(torques[first]), _rms(torques[second]))
            if smaller > max(given, _rms(torques[first] + torques[second])):
                return {second: Reason(Because.CANCELS, (joint,))}
    return {}


def _torques_at(
    result: Identification, j: int, gain: float, names: Sequence[str]
) -> tuple[float, dict[str, np.ndarray]]:
    """RMS torque of motor j in the fitted recordings, N*m or N, and there the torque (N,) of every effect."""
    fitted = [trace for trace in result.recordings if trace.use == "identify"]
    given = np.concatenate([(gain * trace.measured * trace.moving)[:, j] for trace in fitted])
    return _rms(given), {
        name: np.nan_to_num(np.concatenate([trace.by_effect[name][:, j] for trace in fitted]))
        for name in names
    }


def _rms(torque: np.ndarray) -> float:
    return float(np.sqrt(np.mean(torque**2)))


def superfluous_effect(fits: Fits, names: Sequence[str], samples: Samples) -> dict[str, Reason]:
    """The effect that is needed least, if the others, converged without it, are more probable; and why it goes.

    A search compares sets about one model. What made a difference there and makes none now only mended how the others
    were linearised.
    """
    every = frozenset(names)
    without = {name: fits(every - {name}).residual.weight(samples) for name in names}
    name = max(without, key=lambda name: without[name], default=None)
    if name is None or without[name] < fits(every).residual.weight(samples):
        return {}
    return {name: Reason(Because.NOT_NEEDED)}


def improbable_effect(
    fits: Fits, names: Sequence[str], samples: Samples, excess: Callable[[], float]
) -> dict[str, Reason]:
    """The effect that is needed least, if it is improbable where samples count as beyond noise; and why it goes.

    excess: of the model, asked for only where there are several effects: one alone stays as what resembles the residual
    most. The others stay as they are: what would take the place of an improbable effect is no more probable.
    """
    if len(names) < 2:
        return {}
    samples, every = samples.beyond(excess()), frozenset(names)
    without = {name: fits(every - {name}).residual.weight(samples) for name in names}
    name = max(names, key=lambda name: without[name])
    if without[name] - fits(every).residual.weight(samples) < RULE.sure_odds:
        return {}
    return {name: Reason(Because.GAINS_LITTLE)}


def gain_like_effect(
    fits: Fits, names: Sequence[str], samples: Samples, after: Identification, excess: Callable[[], float]
) -> dict[str, Reason]:
    """The effect that moves a drive gain by more than its standard error and is needed least, if the others are more
    probable without it; and why it goes.

    excess: of the model, asked for only where a gain moves. Samples count as they do where the model's error is no
    noise: an effect that trades against a gain, as a saturation or a friction that grows with the load, may then only
    make up for a law that is nearly right, and take the gain along.
    """
    every = frozenset(names)
    without = {name: fits(every - {name}) for name in names}
    moved = [
        (name, joint)
        for name in names
        for joint, gain in after.drive_gains.items()
        if abs(without[name].gains[joint] - gain.value) > RULE.shows * gain.std > 0.0
    ]
    if not moved:
        return {}
    samples = samples.beyond(excess())
    weight, name, joint = max((without[name].residual.weight(samples), name, joint) for name, joint in moved)
    least = fits(every).residual.weight(samples)
    return {name: Reason(Because.MOVES_GAIN, (joint,))} if weight > least else {}


def refused(verdict: EffectVerdict, why: Reason | None) -> EffectVerdict:
    """The verdict on an effect that does not stay for this reason; unchanged where there is none."""
    if why is None:
        return verdict
    return replace(verdict, verdict="not supported", actuators=(), alternatives=(), why=why)
