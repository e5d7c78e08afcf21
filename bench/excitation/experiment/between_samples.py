"""Proven bounds of a Fourier trajectory at all times, also between samples.

Between two samples a distance h apart, a function differs from the line through them by at most h^2 / 8 times the
largest size of its second derivative. Those derivatives are bounded by the sums of the series' coefficients and, in the
ramps, by the derivatives of the blend.
"""

from dataclasses import dataclass
from math import comb

import numpy as np

from bench.excitation.bounds import PROOF
from bench.scenario.trajectory import FourierTrajectory

RISE = (1.0, 35.0 / 16.0, 7.6, 52.5, 840.0)
"""Largest sizes of the blend 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7 and its first four derivatives on [0, 1].

The first is 140 / 4^3, the second 420 x^2 y^2 (y - x) < 7.6 with y = 1 - x, the third 420 |2 u - 10 u^2| at u = x y =
1/4, the fourth that at the ends.
"""


@dataclass(frozen=True)
class Extremes:
    """Bounds of a trajectory at all times, (n,) each: of positions, and largest sizes of its rates."""

    low: np.ndarray
    high: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def extremes(trajectory: FourierTrajectory) -> Extremes:
    """Bounds of position, velocity and acceleration that hold at every time."""
    ramp, duration = trajectory.ramp, trajectory.duration
    pieces = [
        _piece(trajectory, 0.0, ramp, blended=True),
        _piece(trajectory, duration - ramp, duration, blended=True),
    ]
    if duration > 2.0 * ramp:
        pieces.append(_piece(trajectory, ramp, duration - ramp, blended=False))
    return Extremes(
        np.min([piece.low for piece in pieces], axis=0),
        np.max([piece.high for piece in pieces], axis=0),
        np.max([piece.velocity for piece in pieces], axis=0),
        np.max([piece.acceleration for piece in pieces], axis=0),
    )


def derivative_bound(trajectory: FourierTrajectory, order: int, *, blended: bool) -> np.ndarray:
    """Bound (n,) of the derivative of this order, 1 to 4; blended: in the ramps, else between them."""
    k_omega = 2.0 * np.pi * trajectory.base_frequency * np.arange(1, trajectory.harmonics + 1)
    amplitude = np.hypot(trajectory.a, trajectory.b)
    sizes = [(amplitude * k_omega**m).sum(axis=1) for m in range(order + 1)]
    if not blended:
        return np.asarray(sizes[order])
    terms = [comb(order, j) * RISE[j] / trajectory.ramp**j * sizes[order - j] for j in range(order + 1)]
    return np.asarray(np.sum(terms, axis=0))


def _piece(trajectory: FourierTrajectory, start: float, end: float, *, blended: bool) -> Extremes:
    highest = trajectory.harmonics * trajectory.base_frequency
    count = max(int(np.ceil((end - start) * PROOF.period_points * highest)), int(PROOF.ramp_points)) + 1
    position, velocity, acceleration = trajectory.evaluate(np.linspace(start, end, count))
    step = (end - start) / (count - 1)
    beyond = [step**2 / 8.0 * derivative_bound(trajectory, order, blended=blended) for order in (2, 3, 4)]
    return Extremes(
        position.min(axis=0) - beyond[0],
        position.max(axis=0) + beyond[0],
        np.abs(velocity).max(axis=0) + beyond[1],
        np.abs(acceleration).max(axis=0) + beyond[2],
    )


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
