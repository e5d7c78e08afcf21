"""What a planned movement must keep: joint ranges, and its distance from singular poses."""

from dataclasses import dataclass

import numpy as np

from bench.errors import BenchError
from bench.model.geometry import Geometry
from bench.model.motion import Motion, motion_of
from bench.model.states import active_ranges
from bench.trajectory import FourierTrajectory

MARGIN = 0.05  # of a joint's range, kept free at both ends
AMPLIFICATION = 3.0  # times that of the home pose: passive for active speed


@dataclass(frozen=True)
class Limits:
    """Active joint positions as logged, low and high (n,), and the largest entry of the loop Jacobian."""

    low: np.ndarray
    high: np.ndarray
    amplification: float


def limits_of(geometry: Geometry) -> Limits:
    """The limits of a robot, from its joint ranges and its home pose."""
    low, high = active_ranges(geometry)
    low, high = low + geometry.active_offset, high + geometry.active_offset
    margin = MARGIN * (high - low)
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    if np.any(home < low) or np.any(home > high):
        raise BenchError(f"robot {geometry.robot.name}: its home pose lies outside its joint ranges")
    zero = np.zeros((1, len(home)))
    at_home = motion_of(geometry, np.zeros(1), home[None], zero, zero)
    largest = max(1.0, float(np.abs(at_home.jacobian).max()))
    return Limits(np.minimum(low + margin, home), np.maximum(high - margin, home), AMPLIFICATION * largest)


def feasible_motion(
    geometry: Geometry,
    limits: Limits,
    trajectory: FourierTrajectory,
    time: np.ndarray,
    near: Motion | None = None,
) -> Motion | None:
    """The motion at the times (N,) if it keeps the limits, None otherwise.

    near: of nearly this trajectory at the same times; a closure is found sooner from there.
    """
    position, velocity, acceleration = trajectory.evaluate(time)
    if np.any(position < limits.low) or np.any(position > limits.high):
        return None
    try:
        motion = motion_of(geometry, time, position, velocity, acceleration, near=near)
    except BenchError:
        return None
    if np.abs(motion.jacobian).max() > limits.amplification:
        return None
    return motion
