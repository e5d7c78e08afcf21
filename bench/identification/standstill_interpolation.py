"""Straight lines over stretches of samples: what replaces the equations of a joint while it does not move.

The line goes through the means of the samples on either side, those in the middle of a side weighing most (a Hann
window); it is level where there is one side only. All of it is linear in the samples and worked out once.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class StandstillInterpolation:
    """The lines over the stretches of one joint.

    inside (K,): rows that are replaced; near (L,): rows on either side, side after side, with their
    weights (L,), which add up to one in each side; starts: where in these a side begins. before, after (K,): between
    which sides a row lies, and `share` (K,) of the way.
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
        """Put it there, in some columns (indices) of the rows (N, p)."""
        if len(self.inside):
            rows[self.inside[:, None], columns] = self._between(rows[self.near[:, None], columns])

    def put_partly(self, rows: np.ndarray, columns: np.ndarray, share: np.ndarray) -> None:
        """The same by the `share` (N,) that it has of each row."""
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
    """For the chosen stretches, start and stop, and where their surroundings begin before and end after, (k,) each."""
    start, stop, margin = stretches[chosen].T
    last = stretches[chosen.start - 1, 1] if chosen.start else 0
    before = np.maximum(start - margin, np.concatenate(([last], stop))[: len(stop)])
    return start, stop, before, np.minimum(stop + margin, length)


def ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All samples of stretches from start (k,) to before stop (k,), one after the other, and whose they are."""
    length = np.maximum(stop - start, 0)
    of = np.repeat(np.arange(len(length)), length)
    return np.arange(len(of)) + (start - np.cumsum(length) + length)[of], of


def interpolation_over(
    stretches: np.ndarray, samples: np.ndarray, length: int, part: slice
) -> StandstillInterpolation:
    """The lines over a joint's stretches (k, 3) in a part of a recording of so many samples, for its rows at the
    samples (K,), in order; these hold the part's stretches and their surroundings.
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
    """The lines over a joint's stretches (k, 3) in all so many samples of a recording."""
    return _whole_interpolation(stretches.tobytes(), length)


@lru_cache(maxsize=TOLERANCES.memory.interpolations)
def _whole_interpolation(stretches: bytes, length: int) -> StandstillInterpolation:
    given = np.frombuffer(stretches, dtype=int).reshape(-1, 3)
    return interpolation_over(given, np.arange(length), length, slice(0, length))
