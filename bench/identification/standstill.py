"""Where a joint does not move, friction takes any value up to its limit, and no sliding law holds. In a joint without a
motor it then loads all motors.

What is logged there says nothing, and yet the low-pass of the fit spreads it over the rows around. So the
equations of a joint at standstill are replaced, before that filter, by the straight line between the equations
just before and just after: columns and current alike, which keeps every linear model true.
"""

from collections.abc import Sequence

import numpy as np

from bench.identification.standstill_interpolation import (
    interpolation_over,
    ranges,
    sides,
    whole_interpolation,
    within,
)
from bench.identification.tolerances import TOLERANCES
from bench.signals.decimation import decimate

Gaps = tuple[np.ndarray, ...]
"""For each joint, the stretches (k, 3) of samples in which it does not move or reverses: the first, one past the
last, and how many on either side tell of its surroundings."""


def standstills(
    position: np.ndarray, velocity: np.ndarray, passive: np.ndarray, rate: float, cutoff: float
) -> Gaps:
    """Stretches in which joints stand still, set off or reverse, before decimation.

    position, velocity (N, n), rad or m and their rates; passive (N, k): velocities of joints without a motor;
    rate Hz; cutoff of the position filter, Hz. A joint does not move where it is slower than 1 % of its RMS speed;
    reversals count however swift, and so does the first way of a joint that starts from rest. A joint without a
    motor counts, for all motors, only where it stays slow: there it sticks. Stretches reach as far as the position
    filter spreads a jump.
    """
    reach = int(np.ceil(TOLERANCES.motion.smeared * rate / cutoff))
    stuck = _stuck(passive, TOLERANCES.motion.stuck * reach)
    stretches = []
    for q, v in zip(np.ascontiguousarray(position.T), np.ascontiguousarray(velocity.T), strict=True):
        rms = np.sqrt(v @ v / len(v))
        slow = np.abs(v) <= TOLERANCES.motion.slow * rms
        slow[1:] |= v[1:] * v[:-1] < 0.0
        slow |= stuck
        if abs(v[0]) < TOLERANCES.motion.slow_start * rms:
            way = np.maximum.accumulate(np.abs(q - q[0]))
            slow |= way < TOLERANCES.motion.first_way * max(q.max() - q.min(), np.finfo(float).tiny)
        stretches.append(
            _stretches(slow, reach, int(np.ceil(TOLERANCES.motion.surroundings * rate / cutoff)))
        )
    return tuple(stretches)


def interpolated(rows: np.ndarray, gaps: Sequence[np.ndarray]) -> np.ndarray:
    """Rows (N, n) or (N, n, p), those of every joint in its gaps replaced by a straight line; a copy."""
    rows = rows.copy()
    for j, stretches in enumerate(gaps):
        of_motor = rows[:, j].reshape(len(rows), -1)
        interpolation = whole_interpolation(stretches, len(rows))
        rows[interpolation.inside, j] = interpolation.lines(of_motor).reshape(-1, *rows.shape[2:])
    return rows


def around(part: slice, gaps: Gaps, length: int) -> np.ndarray:
    """The samples (K,), of so many, that `interpolated_part` needs for a part of them, in order."""
    outside = [np.empty(0, dtype=int)]
    for stretches in gaps:
        start, stop, before, after = sides(within(stretches, part), stretches, length)
        outside += [
            ranges(before, np.minimum(start, part.start))[0],
            ranges(np.maximum(before, part.stop), start)[0],
            ranges(stop, np.minimum(after, part.start))[0],
            ranges(np.maximum(stop, part.stop), after)[0],
        ]
    more = np.unique(np.concatenate(outside))
    first = np.searchsorted(more, part.start)
    return np.concatenate((more[:first], np.arange(part.start, part.stop), more[first:]))


def interpolated_part(
    rows: np.ndarray, samples: np.ndarray, part: slice, gaps: Gaps, length: int
) -> np.ndarray:
    """The rows of a part as `interpolated` gives them, from those at the samples (K,) that it needs; changes these."""
    for j, stretches in enumerate(gaps):
        interpolation = interpolation_over(stretches, samples, length, part)
        rows[interpolation.inside, j] = interpolation.lines(rows[:, j].reshape(len(rows), -1)).reshape(
            -1, *rows.shape[2:]
        )
    first = int(np.searchsorted(samples, part.start))
    return rows[first : first + part.stop - part.start]


def no_gaps(joints: int) -> Gaps:
    """No standstill anywhere."""
    return tuple(np.empty((0, 3), dtype=int) for _ in range(joints))


def moving_rows(gaps: Gaps, samples: int, decimation: int) -> np.ndarray:
    """Which decimated rows of which joints come from motion except for a small part, (M, n) True or False."""
    inside = np.zeros((samples, len(gaps)))
    for j, stretches in enumerate(gaps):
        for start, stop, _ in stretches:
            inside[start:stop, j] = 1.0
    return np.asarray(decimate(inside, decimation) < TOLERANCES.motion.still_rows)


def _stuck(velocity: np.ndarray, shortest: float) -> np.ndarray:
    """Whether any joint (of k) is slow for at least so many samples on end, (N,)."""
    stuck = np.zeros(len(velocity), dtype=bool)
    for v in np.ascontiguousarray(velocity.T):
        first, last = _runs(np.abs(v) <= TOLERANCES.motion.slow * np.sqrt(v @ v / len(v)))
        long = last - first >= shortest
        stuck[ranges(first[long], last[long])[0]] = True
    return stuck


def _runs(slow: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First sample, and one past the last, of every run of True in (N,)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], slow, [False])).astype(int)))
    return edges[::2], edges[1::2]


def _stretches(slow: np.ndarray, reach: int, margin: int) -> np.ndarray:
    """Runs of True (N,), each longer by `reach` at both ends; those with hardly a sample between them are one.

    margin: samples on either side from which the line is taken.
    """
    runs: list[list[int]] = []
    for start, stop in zip(*_runs(slow), strict=True):
        first, last = max(int(start) - reach, 0), min(int(stop) + reach, len(slow))
        if runs and first - runs[-1][1] < reach:
            runs[-1][1] = last
        else:
            runs.append([first, last, margin])
    return np.array(runs, dtype=int).reshape(-1, 3)
