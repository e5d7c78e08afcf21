"""The torque that each effect of a model takes, sample by sample."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.identification.result import CurrentSeries


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
    """What the motors have to supply for the effects of a model, in each recording."""
    return tuple(EffectTorques(trace.name, trace.time, trace.by_effect) for trace in recordings)
