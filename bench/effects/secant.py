"""Columns of nonlinear effects: difference quotients of the present model's torque."""

from collections.abc import Callable

import numpy as np

from bench.basics.errors import BenchError
from bench.effects.signals import RobotSignals

DIGITS = 4


def secant(
    robot: RobotSignals, about: float, least: float, most: float, change: Callable[[float], np.ndarray]
) -> np.ndarray:
    """The change of torque (N, n) for a parameter, over the parameter: one column (N, n, 1).

    The parameter's value is `about` to DIGITS digits, so that a cached change serves for small moves; its size is
    between the bounds. If the loops cannot be closed with it, the least value of either sign is tried; if they never
    close, the column is zero.
    """
    size = min(max(abs(rounded(about)), least), most)
    for step in (-size if about < 0 else size, least, -least):
        try:
            changed = change(step)
        except BenchError:  # out of reach, or singular
            continue
        return (changed / step)[:, :, None]
    return np.zeros((len(robot.time), len(robot.joints), 1))


def rounded(value: float) -> float:
    """A value to DIGITS digits, so that results serve for all similar values."""
    return float(f"{value:.{DIGITS - 1}e}")
