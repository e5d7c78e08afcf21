"""Friction beside the rigid bodies, where something else than friction is looked for."""

import numpy as np

from bench.identification.observation import Observation


def friction_columns(observation: Observation) -> np.ndarray:
    """Dry and viscous friction of every motor at the fit's rate, (M, n, 2 n): nearly every machine has them."""
    motors = np.arange(observation.velocity.shape[1])
    columns = np.zeros((*observation.velocity.shape, 2 * len(motors)))
    columns[:, motors, 2 * motors] = np.sign(observation.velocity)
    columns[:, motors, 2 * motors + 1] = observation.velocity
    return columns
