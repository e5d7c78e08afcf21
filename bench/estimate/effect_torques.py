"""The torque that each effect of a model takes, sample by sample."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.dataset import Dataset
from bench.effects import Effect
from bench.estimate.model_file import SavedModel, applied


@dataclass(frozen=True, eq=False)
class EffectTorques:
    """Torques in one recording at the fit's rate: time (M,) s; by_effect: (M, n) N*m or N for each effect.

    NaN where a joint stands still: such rows are bridged, not modelled.
    """

    name: str
    time: np.ndarray
    by_effect: Mapping[str, np.ndarray]

    @property
    def total(self) -> np.ndarray | None:
        """All effects together (M, n); None for a model without any."""
        return sum(self.by_effect.values(), np.zeros(())) if self.by_effect else None


def effect_torques(
    dataset: Dataset, model: SavedModel, catalogue: Mapping[str, Effect] | None = None
) -> tuple[EffectTorques, ...]:
    """What the motors have to supply for the effects of a model, filtered as the fit's currents are.

    Raises BenchError where model and dataset do not go together, as `apply_model` does.
    """
    prepared, solution = applied(dataset, model, catalogue)
    first = prepared.layout.size - prepared.layout.effects
    found = []
    for seen in prepared.observations:
        by_effect: dict[str, np.ndarray] = {}
        at = 0
        for instance in prepared.effects:
            size = len(instance.effect.parameters)
            values = solution.theta[first + at : first + at + size]
            torque = np.where(seen.moving, seen.effects[:, :, at : at + size] @ values, np.nan)
            name = instance.effect.name
            by_effect[name] = by_effect[name] + torque if name in by_effect else torque
            at += size
        found.append(EffectTorques(seen.name, seen.time, by_effect))
    return tuple(found)
