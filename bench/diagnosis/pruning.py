"""Identified effects that are removed: of an impossible sign, or not needed when the others are converged again."""

from collections.abc import Sequence
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
    """Effects of which a parameter that must be positive is clearly negative at all places; and the reason."""
    by_name: dict[str, list[list[str]]] = {}
    for instance in added:
        by_name.setdefault(instance.name, []).append(wrong_signs(result, instance))
    return {name: Reason(Because.IMPOSSIBLE, (wrong[0][0],)) for name, wrong in by_name.items() if all(wrong)}


def impossible_but_needed(whole: Identification, dropped: Sequence[EffectInstance]) -> dict[str, Reason]:
    """Effects omitted at places with an impossible sign, if this makes the model less probable; and the reason.

    Something like them is needed there: a possible part of theirs, as Coulomb friction in Stribeck's law, or something
    that no effect explains. Either is searched without them. whole: before they were omitted.
    """
    reasons: dict[str, Reason] = {}
    for instance in dropped:
        if wrong := wrong_signs(whole, instance):
            reasons[instance.name] = Reason(Because.IMPOSSIBLE, (wrong[-1], instance.place))
    return reasons


def cancelling_effect(result: Identification, added: Sequence[EffectInstance]) -> dict[str, Reason]:
    """The last added effect whose torque is many times the motor's, or cancels that of another: its size is not
    determined.
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
    """RMS torque of motor j in the fitted recordings, N*m or N, and the torque (N,) of every effect there."""
    fitted = [trace for trace in result.recordings if trace.use == "identify"]
    given = np.concatenate([(gain * trace.measured * trace.moving)[:, j] for trace in fitted])
    return _rms(given), {
        name: np.nan_to_num(np.concatenate([trace.by_effect[name][:, j] for trace in fitted]))
        for name in names
    }


def _rms(torque: np.ndarray) -> float:
    return float(np.sqrt(np.mean(torque**2)))


def superfluous_effect(fits: Fits, names: Sequence[str], samples: Samples) -> dict[str, Reason]:
    """The least needed effect, if the others, converged without it, are more probable; and the reason.

    samples: as they count at the error of the model with all. A search compares sets about one model. An effect that
    helped there and no longer does only compensated for the linearisation of the others.
    """
    every = frozenset(names)
    without = {name: fits(every - {name}).residual.weight(samples) for name in names}
    name = max(without, key=lambda name: without[name], default=None)
    if name is None or without[name] < fits(every).residual.weight(samples):
        return {}
    return {name: Reason(Because.NOT_NEEDED)}


def refused(verdict: EffectVerdict, why: Reason | None) -> EffectVerdict:
    """The verdict on an effect that is removed for this reason; unchanged without one."""
    if why is None:
        return verdict
    return replace(verdict, verdict="not supported", actuators=(), alternatives=(), why=why)
