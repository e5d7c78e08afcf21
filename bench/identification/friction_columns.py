"""Friction in addition to the rigid bodies, where something else than friction is looked for."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bench.dataset.payload import Payload
from bench.identification.layout import ParameterLayout, known_rows, regressor_rows
from bench.identification.observation import Observation


def friction_columns(observation: Observation) -> np.ndarray:
    """Dry and viscous friction of every motor at the fit's rate, (M, n, 2 n): nearly every machine has them."""
    motors = np.arange(observation.velocity.shape[1])
    columns = np.zeros((*observation.velocity.shape, 2 * len(motors)))
    columns[:, motors, 2 * motors] = np.sign(observation.velocity)
    columns[:, motors, 2 * motors + 1] = observation.velocity
    return columns


def with_friction(layout: ParameterLayout, motors: int) -> ParameterLayout:
    """The layout of equations in which every motor has dry and viscous friction, and no other effect."""
    return replace(layout, effects=2 * motors)


def rows_with_friction(
    observation: Observation, layout: ParameterLayout, payloads: Mapping[str, Payload]
) -> np.ndarray:
    """Rows (M, n, p + 1) of [phi, kappa] with friction; layout: from `with_friction`."""
    rows = np.empty((*observation.velocity.shape, layout.size + 1))
    rows[:, :, :-1] = regressor_rows(replace(observation, effects=friction_columns(observation)), layout)
    rows[:, :, -1] = known_rows(observation, payloads)
    return rows
