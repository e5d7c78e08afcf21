"""Bounds of positions, velocities and accelerations of a trajectory during short intervals."""

from dataclasses import dataclass

import numpy as np

from bench.excitation.experiment.between_samples import derivative_bound
from bench.scenario.trajectory import FourierTrajectory


@dataclass(frozen=True)
class Intervals:
    """Times from `middle` - `half` to `middle` + `half`, (K,) s each, in order of time."""

    middle: np.ndarray
    half: np.ndarray

    def cut(self, parts: np.ndarray) -> "Intervals":
        """Each cut into parts (K,) of equal length, in order."""
        first = np.repeat(np.cumsum(parts) - parts, parts)
        half = np.repeat(self.half / parts, parts)
        steps = 2.0 * (np.arange(len(half)) - first) + 1.0
        return Intervals(np.repeat(self.middle - self.half, parts) + steps * half, half)

    def at(self, chosen: np.ndarray) -> "Intervals":
        """Some of them."""
        return Intervals(self.middle[chosen], self.half[chosen])


@dataclass(frozen=True)
class MotorBalls:
    """Positions, velocities and accelerations in the intervals' middles, (3, K, n), and their radii in the
    intervals.
    """

    middle: np.ndarray
    radius: np.ndarray

    def at(self, chosen: np.ndarray) -> "MotorBalls":
        """In some of the intervals."""
        return MotorBalls(self.middle[:, chosen], self.radius[:, chosen])


def intervals_of(trajectory: FourierTrajectory, rate: float) -> Intervals:
    """A motion cut into intervals of the same length, at least `rate` of them a second."""
    count = int(np.ceil(trajectory.duration * rate))
    edges = np.linspace(0.0, trajectory.duration, count + 1)
    return Intervals(0.5 * (edges[1:] + edges[:-1]), np.full(count, 0.5 * trajectory.duration / count))


def motor_balls(trajectory: FourierTrajectory, intervals: Intervals) -> MotorBalls:
    """The motors in every interval.

    On either half of an interval a function differs from the line through its ends by at most half^2 / 8 times the
    largest second derivative.
    """
    first, last = intervals.middle - intervals.half, intervals.middle + intervals.half
    before, middle, after = (np.array(trajectory.evaluate(time)) for time in (first, intervals.middle, last))
    away = np.maximum(np.abs(before - middle), np.abs(after - middle))
    inside = (first >= trajectory.ramp) & (last <= trajectory.duration - trajectory.ramp)
    between, in_ramps = (
        np.array([derivative_bound(trajectory, order, blended=blended) for order in (2, 3, 4)])[:, None]
        for blended in (False, True)
    )
    bent = np.where(inside[:, None], between, in_ramps)
    rounding = 1e-12 * (np.abs(middle) + np.abs(trajectory.center) + 1.0)
    return MotorBalls(middle, away + intervals.half[:, None] ** 2 / 8.0 * bent + rounding)
