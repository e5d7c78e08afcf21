"""The load of one motor."""

from collections.abc import Callable, Sequence

import numpy as np

from bench.effects.signals import RobotSignals

PASSES = 4  # to make a load and a law's part in it consistent
MOST = 0.7  # of the largest load: bound for a law's part


def load_at(robot: RobotSignals, joint: str) -> np.ndarray:
    """Torque or force (N,) that the present model needs of an actuated joint, N*m or N.

    Without effects that use it themselves: a law of the load is not part of it, see `with_itself`.
    """
    return robot.joints[joint].needed_torque


def with_itself(
    rest: np.ndarray, law: Callable[[np.ndarray], np.ndarray], values: Sequence[float]
) -> np.ndarray:
    """The load (N,) including a law: `rest` (N,), plus the law's columns (N, p) at this load times values (p,).

    A gear's friction depends on all of its torque.
    """
    most = MOST * float(np.abs(rest).max(initial=0.0))
    load = rest
    for _ in range(PASSES if np.any(values) else 0):
        load = rest + np.clip(law(load) @ np.asarray(values, dtype=float), -most, most)
    return load
