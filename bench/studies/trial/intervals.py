"""Estimated parameters of hidden effects compared with the truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bench.identification.result import Identification
from bench.identification.summary import ROBOT
from bench.studies.trial.realise import Entry, hidden_places
from bench.studies.trial.setup import Setup, where
from bench.studies.trial.true_effects import as_logged, true_values
from bench.truth.simulate import Simulation

SAME = 0.03  # of the RMS speed: two joints whose rates differ less turn alike, even where one length is wrong


def moving_alike(simulation: Simulation, joints: Sequence[str]) -> dict[str, str]:
    """For each of these joints the first of them that moves like it, or against it: itself, if it moves alone.

    The rods of a parallelogram do. The motors see the sum of their frictions.
    """
    model = simulation.machine.models[None]
    rates = {
        joint: np.concatenate(
            [
                recording.motion.qvel[:, int(model.joint(joint).dofadr[0])]
                for recording in simulation.recordings
            ]
        )
        for joint in joints
    }

    def alike(a: str, b: str) -> bool:
        nearer = min(_rms(rates[a] - rates[b]), _rms(rates[a] + rates[b]))
        return nearer <= SAME * _rms(rates[b])

    return {
        joint: next(first for first in joints if first == joint or alike(first, joint)) for joint in joints
    }


def intervals(
    setup: Setup, hidden: Sequence[Entry], result: Identification, alike: Mapping[str, str]
) -> list[Mapping[str, Any]]:
    """Estimated value, deviation and truth of the parameters of the hidden effects that the model has.

    alike: see `moving_alike`; the true friction of passive joints that move alike is the sum of theirs.
    """
    true: dict[tuple[str, str, str], float] = {}
    for effect, place, entry in hidden_places(setup, as_logged(hidden)):
        for name, value in true_values(effect, {k: v for k, v in entry.items() if k != "effect"}).items():
            key = (effect, alike.get(place, place) if where(effect) == "passive" else place, name)
            true[key] = true.get(key, 0.0) + value if where(effect) == "passive" else value
    rows: list[Mapping[str, Any]] = []
    for effect in dict.fromkeys(effect for effect, _, _ in true):
        places = result.effect_parameters.get(effect, {})
        for place, values in places.items():
            for name, quantity in values.items():
                at = "" if place == ROBOT else place
                truth = true.get((effect, alike.get(at, at) if where(effect) == "passive" else at, name))
                if truth is not None and 0 < quantity.std < np.inf:
                    rows.append(
                        {"effect": effect, "at": at, "parameter": name}
                        | {"truth": truth, "value": quantity.value, "std": quantity.std}
                    )
    return rows


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
