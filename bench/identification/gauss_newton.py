"""Gauss-Newton steps for errors of currents that are bilinear in unknown values and drive gains, of many problems at
once.

Values and gains move in proportion: a gain that the data do not determine takes the torques of its motor along.
"""

from dataclasses import dataclass
from typing import Literal, Protocol, Self

import numpy as np

from bench.identification.tolerances import TOLERANCES

End = Literal["converged", "far", "stuck", "unfinished"]
"""Why steps ended: the cost hardly falls any more, the gains are far from those of the reference while it still falls,
no part of the next step lowers it, or there were too many steps.
"""


class Bilinear(Protocol):
    """S problems at values (S, k) and gains (S, n), with the sums of squares (S, n) of every motor's current error."""

    @property
    def values(self) -> np.ndarray:
        """Values (S, k)."""

    @property
    def gains(self) -> np.ndarray:
        """Drive gains (S, n)."""

    @property
    def squares(self) -> np.ndarray:
        """Sums of squares (S, n)."""

    def step(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Steps of values (S, k) and gains (S, n) towards the least sum of squares, weights (n,) squared."""

    def moved(self, values: np.ndarray, gains: np.ndarray) -> Self:
        """The same problems at other values and gains."""

    def some(self, which: np.ndarray) -> Self:
        """Some of the problems, (S,) True or False."""


@dataclass(frozen=True)
class Until:
    """When steps end: at a relative decrease of the cost below `tolerance`, or, where steps creep, below `unseen`.

    A gain beyond a factor `reach` from the reference is far: steps then end below `tolerance_beyond`, at once if this
    is one.
    """

    tolerance: float
    unseen: float = 0.0
    reach: float = np.inf
    tolerance_beyond: float = 0.0


@dataclass(frozen=True)
class Minima:
    """Where the steps of S problems ended, values (S, k), gains (S, n) and squares (S, n), and why."""

    values: np.ndarray
    gains: np.ndarray
    squares: np.ndarray
    why: tuple[End, ...]


def minimised(start: Bilinear, reference: np.ndarray, weights: np.ndarray, until: Until) -> Minima:
    """The minima of the weighted squares by steps that are halved until they lower the cost.

    reference (n,): gains from which `Until.reach` counts; weights (n,): of the motors' errors.
    """
    bounds, squared = TOLERANCES.steps, weights**2
    values, gains, squares = (part.copy() for part in (start.values, start.gains, start.squares))
    why: list[End] = ["unfinished"] * len(gains)
    now, open_ones = start, np.arange(len(gains))
    cost, last = now.squares @ squared, np.full(len(gains), np.inf)
    for _ in range(bounds.most):
        new, whole = _lower(now, cost, weights)
        new_cost = new.squares @ squared
        fall, lower = cost - new_cost, new_cost <= cost * (1.0 + bounds.rounding)
        far = beyond(new.gains / reference, until.reach)
        ends = whole & ((fall <= until.tolerance * cost) | creeps(fall, last, until.unseen * cost))
        ends |= far & (fall <= until.tolerance_beyond * cost)
        at = open_ones[lower]
        values[at], gains[at], squares[at] = new.values[lower], new.gains[lower], new.squares[lower]
        endless = far & (fall > bounds.endless * new_cost)
        for i in np.flatnonzero(~lower | ends):
            why[open_ones[i]] = "stuck" if not lower[i] else "far" if endless[i] else "converged"
        on = lower & ~ends
        if not on.any():
            break
        now = new if on.all() else new.some(on)
        open_ones, cost, last = open_ones[on], new_cost[on], fall[on]
    return Minima(values, gains, squares, tuple(why))


def _lower(now: Bilinear, cost: np.ndarray, weights: np.ndarray) -> tuple[Bilinear, np.ndarray]:
    """The problems after steps within reach, halved until the cost (S,) is no higher, and whether they are not (S,)."""
    bounds = TOLERANCES.steps
    step, by_gain = now.step(weights)
    share = share_within_reach(now.gains, by_gain)
    whole = np.ones(len(share), dtype=bool)
    while True:
        part = share[:, None]
        new = now.moved(now.values + part * step, now.gains + part * by_gain)
        lower = new.squares @ weights**2 <= cost * (1.0 + bounds.rounding)
        halved = ~lower & (share > bounds.least_share)
        if not halved.any():
            return new, whole
        share[halved] /= 2.0
        whole &= ~halved


def share_within_reach(gains: np.ndarray, by_gain: np.ndarray) -> np.ndarray:
    """Share (...) of a whole step at which no gain (..., n) changes by more than a factor."""
    most = TOLERANCES.steps.gain_factor
    change = by_gain / gains
    up, down = change.max(axis=-1) / (most - 1.0), -change.min(axis=-1) / (1.0 - 1.0 / most)
    return np.asarray(1.0 / np.maximum(1.0, np.maximum(up, down)))


def creeps(fall: np.ndarray, last: np.ndarray, unseen: np.ndarray) -> np.ndarray:
    """Whether steps creep: each lowers the cost by less than `unseen`, in a hardly determined direction."""
    return (TOLERANCES.steps.creeping * last < fall) & (fall <= unseen)


def beyond(ratio: np.ndarray, factor: float) -> np.ndarray:
    """Whether a gain, by its ratio (..., n) to that of the reference, is farther than a factor, up or down."""
    return np.asarray(~((ratio > 1.0 / factor) & (ratio < factor)).all(axis=-1))


def run_away(ratio: np.ndarray) -> np.ndarray:
    """Whether a gain has run away, so that a solution is useless; ratio (..., n): of the gains to the reference's."""
    return beyond(ratio, TOLERANCES.steps.runaway_factor)
