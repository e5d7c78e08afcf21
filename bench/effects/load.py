"""What is asked of one motor."""

from collections.abc import Callable, Sequence

import numpy as np

from bench.effects.signals import RobotSignals

PASSES = 4  # in which a load and the part that a law has in it become one
MOST = 0.7  # of the largest load: what a law may add to it


def load_at(robot: RobotSignals, joint: str) -> np.ndarray:
    """Torque or force (N,) that the present model needs of an actuated joint, N*m or N.

    With its effects but those that ask for it themselves: a law of the load is no part of it, see `with_itself`.
    """
    return robot.joints[joint].needed_torque


def with_itself(
    rest: np.ndarray, law: Callable[[np.ndarray], np.ndarray], values: Sequence[float]
) -> np.ndarray:
    """The load (N,) of which a law is a part: `rest` (N,), and the law's columns (N, p) at it times values (p,).

    As a gear's friction goes by all that its motor gives.
    """
    most = MOST * float(np.abs(rest).max(initial=0.0))
    load = rest
    for _ in range(PASSES if np.any(values) else 0):
        load = rest + np.clip(law(load) @ np.asarray(values, dtype=float), -most, most)
    return load
