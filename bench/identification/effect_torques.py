"""The torque of each effect of a model: sample by sample, and as RMS at each motor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects.select import parameter_slices
from bench.identification.prepare import Prepared
from bench.identification.result import CurrentSeries, Identification
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True, eq=False)
class EffectTorques:
    """Torques in one recording at the fit's rate: time (M,) s; by_effect: as in `CurrentSeries`."""

    name: str
    time: np.ndarray
    by_effect: Mapping[str, np.ndarray]

    @property
    def total(self) -> np.ndarray | None:
        """All effects together (M, n); None for a model without any."""
        return sum(self.by_effect.values(), np.zeros(())) if self.by_effect else None


def effect_torques(recordings: Sequence[CurrentSeries]) -> tuple[EffectTorques, ...]:
    """Torques that the motors supply for the effects of a model, in each recording."""
    return tuple(EffectTorques(trace.name, trace.time, trace.by_effect) for trace in recordings)


def sizes_of(model: Prepared, result: Identification, effect: str) -> dict[str, float]:
    """RMS torque of an effect at each motor over the fitted recordings, N*m or N; empty if the model lacks it."""
    joints = list(model.dataset.robot.joints)
    total = None
    for instance, part in parameter_slices(model.effects):
        if instance.name == effect:
            quantities = result.effect_parameters[effect][instance.place]
            values = np.array([quantities[parameter.name].value for parameter in instance.effect.parameters])
            torque = np.concatenate([seen.effects[:, :, part] @ values for seen in model.fitted])
            total = torque if total is None else total + torque
    if total is None:
        return {}
    rms = np.sqrt((total**2).mean(axis=0))
    least = TOLERANCES.rank.torque * rms.max()
    return {joint: float(value) for joint, value in zip(joints, rms, strict=True) if value > least}
