"""While a joint is at rest, friction takes any value up to its limit, and no sliding law holds. In a joint without a
motor it loads all motors.

Such rows carry no information, but the fit's low-pass spreads them over their neighbours. So before that filter the
equations of a joint at rest are replaced by the straight line between the equations just before and just after, in
columns and current alike, which keeps every linear model true. The line goes through the means of the samples on either
side, weighted by a Hann window; with one side only it is level.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.identification.tolerances import TOLERANCES
from bench.signals.decimation import decimate


@dataclass(frozen=True)
class StandstillInterpolation:
    """Lines over the stretches of one joint.

    inside (K,): rows that are replaced; near (L,): rows on either side, side after side, with their weights (L,), which
    add up to one in each side; starts: where in these each side begins. before, after (K,): the sides of a row, and
    `share` (K,) of the way between them.
    """

    inside: np.ndarray
    near: np.ndarray
    weights: np.ndarray
    starts: np.ndarray
    before: np.ndarray
    after: np.ndarray
    share: np.ndarray

    def lines(self, rows: np.ndarray) -> np.ndarray:
        """The interpolated values (K, p) of the rows (N, p) inside."""
        return self._between(rows[self.near])

    def put(self, rows: np.ndarray, columns: np.ndarray) -> None:
        """Put it into some columns (indices) of the rows (N, p)."""
        if len(self.inside):
            rows[self.inside[:, None], columns] = self._between(rows[self.near[:, None], columns])

    def put_partly(self, rows: np.ndarray, columns: np.ndarray, share: np.ndarray) -> None:
        """The same, weighted by `share` (N,) in each row."""
        if len(self.inside):
            inside = rows[self.inside[:, None], columns]
            lines = self._between(rows[self.near[:, None], columns])
            inside += share[self.inside, None] * (lines - inside)
            rows[self.inside[:, None], columns] = inside

    def _between(self, near: np.ndarray) -> np.ndarray:
        """The lines (K, p) from the rows near (L, p), which are changed."""
        if not len(self.inside):
            return near[:0]
        near *= self.weights[:, None]
        means = np.add.reduceat(near, self.starts)
        interpolated: np.ndarray = means[self.after] - means[self.before]
        interpolated *= self.share[:, None]
        interpolated += means[self.before]
        return interpolated


def within(stretches: np.ndarray, part: slice) -> slice:
    """Which stretches (k, 3), one after the other, have samples in the part."""
    first = np.searchsorted(stretches[:, 1], part.start, side="right")
    return slice(int(first), max(int(first), int(np.searchsorted(stretches[:, 0], part.stop))))


def sides(
    chosen: slice, stretches: np.ndarray, length: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Start and stop of the chosen stretches, and where their surroundings begin and end, (k,) each."""
    start, stop, margin = stretches[chosen].T
    last = stretches[chosen.start - 1, 1] if chosen.start else 0
    before = np.maximum(start - margin, np.concatenate(([last], stop))[: len(stop)])
    return start, stop, before, np.minimum(stop + margin, length)


def ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All samples of stretches from start (k,) to before stop (k,), and the stretch of each."""
    length = np.maximum(stop - start, 0)
    of = np.repeat(np.arange(len(length)), length)
    return np.arange(len(of)) + (start - np.cumsum(length) + length)[of], of


def interpolation_over(
    stretches: np.ndarray, samples: np.ndarray, length: int, part: slice
) -> StandstillInterpolation:
    """The lines over a joint's stretches (k, 3) in a part of a recording of `length` samples, for its rows at the
    samples (K,), in order; these hold its stretches and their surroundings.
    """
    start, stop, before, after = sides(within(stretches, part), stretches, length)
    first, last = np.concatenate((before, stop)), np.concatenate((start, after))
    there = last > first
    side = np.cumsum(there) - 1
    near, of_side = ranges(first[there], last[there])
    begin, end = first[there][of_side], last[there][of_side]
    weights = np.sin(np.pi * (near - begin + 0.5) / (end - begin)) ** 2
    starts = np.searchsorted(of_side, np.arange(int(there.sum())))
    if len(starts):
        weights /= np.add.reduceat(weights, starts)[of_side]

    has_first, has_second = np.split(there, 2)
    same, other = np.split(side, 2)
    before_gap, after_gap = np.where(has_first, same, other), np.where(has_second, other, same)
    middle, further = 0.5 * (before + start - 1), 0.5 * (stop + after - 1)
    inside, of = ranges(np.maximum(start, part.start), np.minimum(stop, part.stop))
    some = (has_first | has_second)[of]
    inside, of = inside[some], of[some]
    return StandstillInterpolation(
        inside=np.searchsorted(samples, inside),
        near=np.searchsorted(samples, near),
        weights=weights,
        starts=starts,
        before=before_gap[of],
        after=after_gap[of],
        share=(inside - middle[of]) / (further - middle)[of],
    )


def whole_interpolation(stretches: np.ndarray, length: int) -> StandstillInterpolation:
    """The lines over a joint's stretches (k, 3) in all samples of a recording."""
    return _whole_interpolation(stretches.tobytes(), length)


@lru_cache(maxsize=TOLERANCES.memory.interpolations)
def _whole_interpolation(stretches: bytes, length: int) -> StandstillInterpolation:
    given = np.frombuffer(stretches, dtype=int).reshape(-1, 3)
    return interpolation_over(given, np.arange(length), length, slice(0, length))


Gaps = tuple[np.ndarray, ...]
"""For each joint, stretches (k, 3) of samples in which it is at rest or reverses: the first, one past the last, and the
number on either side that represent the surroundings.
"""


def standstills(
    position: np.ndarray, velocity: np.ndarray, passive: np.ndarray, rate: float, cutoff: float
) -> Gaps:
    """Stretches in which joints are at rest, start or reverse, before decimation.

    position, velocity (N, n), rad or m and their rates; passive (N, k): velocities of joints without a motor; rate Hz;
    cutoff of the position filter, Hz. A joint is at rest if slower than 1 % of its RMS speed; reversals count however
    fast, and so does the first part of a motion from rest. A joint without a motor counts, for all motors, only if it
    stays slow, which means that it sticks. Stretches extend as far as the position filter spreads a jump.
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
    """The samples (K,) of all `length` that `interpolated_part` needs for a part, in order."""
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
    """The rows of a part, as from `interpolated`, computed from those at the samples (K,), in place."""
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
    """Which decimated rows of each joint come from motion except for a small part, (M, n) True or False."""
    inside = np.zeros((samples, len(gaps)))
    for j, stretches in enumerate(gaps):
        for start, stop, _ in stretches:
            inside[start:stop, j] = 1.0
    return np.asarray(decimate(inside, decimation) < TOLERANCES.motion.still_rows)


def _stuck(velocity: np.ndarray, shortest: float) -> np.ndarray:
    """Whether any joint is slow for at least `shortest` samples on end, (N,)."""
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
    """Runs of True (N,), extended by `reach` at both ends; runs with hardly a sample between are merged.

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
