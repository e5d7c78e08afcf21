"""Limits of a planned movement: joint ranges, and the distance from singular poses."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.excitation.bounds import LIMITS
from bench.model.geometry import Geometry
from bench.model.mobility import least_held, smallest_singular_values
from bench.model.motion import Motion, motion_of
from bench.model.passive_ranges import PassiveRange, passive_ranges
from bench.model.states import active_ranges
from bench.scenario.trajectory import FourierTrajectory


@dataclass(frozen=True)
class Limits:
    """Active joint positions as logged, low and high (n,), the largest entry of the loop Jacobian, and the smallest
    singular value of the closures by the passive joints.
    """

    low: np.ndarray
    high: np.ndarray
    amplification: float
    held: float


def limits_of(geometry: Geometry) -> Limits:
    """The limits of a robot, from its joint ranges and its home pose."""
    low, high = active_ranges(geometry)
    low, high = low + geometry.active_offset, high + geometry.active_offset
    margin = LIMITS.margin * (high - low)
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    if np.any(home < low) or np.any(home > high):
        raise BenchError(f"robot {geometry.robot.name}: its home pose lies outside its joint ranges")
    zero = np.zeros((1, len(home)))
    at_home = motion_of(geometry, np.zeros(1), home[None], zero, zero)
    largest = max(1.0, float(np.abs(at_home.jacobian).max()))
    held = float(smallest_singular_values(geometry, geometry.home[None])[0]) if geometry.closed else 0.0
    return Limits(
        np.minimum(low + margin, home),
        np.maximum(high - margin, home),
        LIMITS.amplification * largest,
        LIMITS.held * held,
    )


def passive_room(geometry: Geometry) -> tuple[PassiveRange, ...]:
    """The ranges of passive joints for motions, with a margin to end stops, since a controller follows a motion only
    approximately. If home is within the margin, half of its distance from the end is kept.
    """
    return tuple(
        _with_margin(limit, float(limit.at(geometry.home[None])[0])) for limit in passive_ranges(geometry)
    )


def _with_margin(limit: PassiveRange, home: float) -> PassiveRange:
    low, high = limit.low, limit.high
    margin = LIMITS.margin * (high - (low if np.isfinite(low) else 0.0))
    return replace(
        limit,
        low=low + min(margin, 0.5 * max(home - low, 0.0)),
        high=high - min(margin, 0.5 * max(high - home, 0.0)),
    )


def keeps_clear(geometry: Geometry, limits: Limits, motion: Motion) -> bool:
    """Whether a motion keeps its distance from singular poses, even when slow.

    When the rods of a five-bar are in line, no joint need move fast, and yet the rods can turn either way.
    """
    if not geometry.closed:
        return True
    _, held = least_held(geometry, motion.q, LIMITS.poses)
    return bool(held.min() > limits.held)


def feasible_motion(
    geometry: Geometry,
    limits: Limits,
    trajectory: FourierTrajectory,
    time: np.ndarray,
    near: Motion | None = None,
) -> Motion | None:
    """The motion at the times (N,) if it keeps the limits, else None.

    near: of a similar trajectory at the same times, from which closures converge faster.
    """
    states = trajectory.evaluate(time)
    if np.any(states[0] < limits.low) or np.any(states[0] > limits.high):
        return None
    return reached_motion(geometry, limits.amplification, time, states, near)


def reached_motion(
    geometry: Geometry, most: float, time: np.ndarray, states: Sequence[np.ndarray], near: Motion | None
) -> Motion | None:
    """The motion of the motors' positions, velocities and accelerations (N, n), if its loops close with an
    amplification of at most `most`; near: see `feasible_motion`.
    """
    position, velocity, acceleration = states
    try:
        motion = motion_of(geometry, time, position, velocity, acceleration, near=near, most=most)
    except BenchError:  # out of reach, or through a singular pose
        return None
    return None if np.abs(motion.jacobian).max() > most else motion
