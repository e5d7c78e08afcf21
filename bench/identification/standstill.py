"""Where a joint stands still, friction takes any value up to its limit, and no sliding law holds. In a joint without a
motor it then loads all motors.

What is logged there says nothing, and yet the low-pass of the fit spreads it over the rows around. So the
equations of a joint at standstill are replaced, before that filter, by the straight line between the equations
just before and just after: columns and current alike, which keeps every linear model true.
"""

from collections.abc import Sequence

import numpy as np

from bench.signals.decimation import decimate

SLOW = 0.01  # of the joint's RMS speed
SMEARED = 0.5  # cut-off periods of the position filter that a jump of the acceleration is spread over, on either side
DWELL = 0.5  # of that time: how long a joint without a motor has to be slow, to count as one that sticks
START = 0.3  # of the RMS speed: slower at its first sample, a joint starts from rest
FIRST_WAY = 0.03  # of a joint's travel: before that, friction still depends on how the joint came to rest
AROUND = (
    4.0  # likewise, of what tells of the surroundings: the noise in it is averaged as by the fit's low-pass
)
MOST = 0.2  # of a row that may come from standstill before it is excluded

Gaps = tuple[np.ndarray, ...]
"""For each joint, the stretches (k, 3) of samples in which it stands still or reverses: the first, one past the
last, and how many on either side tell of its surroundings."""


def standstills(
    position: np.ndarray, velocity: np.ndarray, passive: np.ndarray, rate: float, cutoff: float
) -> Gaps:
    """Stretches in which joints stand still, set off or reverse, before decimation.

    position, velocity (N, n), rad or m and their rates; passive (N, k): velocities of joints without a motor;
    rate Hz; cutoff of the position filter, Hz. A joint stands still where it is slower than 1 % of its RMS speed;
    reversals count however swift, and so does the first way of a joint that starts from rest. A joint without a
    motor counts, for all motors, only where it stays slow: there it sticks. Stretches reach as far as the position
    filter spreads a jump.
    """
    reach = int(np.ceil(SMEARED * rate / cutoff))
    stuck = _stuck(passive, DWELL * reach)
    found = []
    for q, v in zip(np.ascontiguousarray(position.T), np.ascontiguousarray(velocity.T), strict=True):
        rms = np.sqrt(v @ v / len(v))
        slow = np.abs(v) <= SLOW * rms
        slow[1:] |= v[1:] * v[:-1] < 0.0
        slow |= stuck
        if abs(v[0]) < START * rms:
            way = np.maximum.accumulate(np.abs(q - q[0]))
            slow |= way < FIRST_WAY * max(q.max() - q.min(), np.finfo(float).tiny)
        found.append(_stretches(slow, reach, int(np.ceil(AROUND * rate / cutoff))))
    return tuple(found)


def bridged(rows: np.ndarray, gaps: Sequence[np.ndarray]) -> np.ndarray:
    """Rows (N, n) or (N, n, p), those of every joint in its gaps replaced by a straight line; a copy.

    The line goes through the means of the samples on either side, those in the middle of a side weighing most
    (a Hann window); it is level where there is one side only.
    """
    rows = rows.copy()
    every = np.arange(len(rows))
    for j, stretches in enumerate(gaps):
        _bridge(rows[:, j], stretches, every, len(rows))
    return rows


def around(part: slice, gaps: Gaps, length: int) -> np.ndarray:
    """The samples (K,), of so many, that `bridged_part` needs for a part of them, in order."""
    outside = [np.empty(0, dtype=int)]
    for stretches in gaps:
        start, stop, before, after = _sides(_within(stretches, part), stretches, length)
        outside += [
            _ranges(before, np.minimum(start, part.start))[0],
            _ranges(np.maximum(before, part.stop), start)[0],
            _ranges(stop, np.minimum(after, part.start))[0],
            _ranges(np.maximum(stop, part.stop), after)[0],
        ]
    more = np.unique(np.concatenate(outside))
    first = np.searchsorted(more, part.start)
    return np.concatenate((more[:first], np.arange(part.start, part.stop), more[first:]))


def bridged_part(rows: np.ndarray, samples: np.ndarray, part: slice, gaps: Gaps, length: int) -> np.ndarray:
    """The rows of a part as `bridged` gives them, from those at the samples (K,) that it needs; changes these."""
    for j, stretches in enumerate(gaps):
        _bridge(rows[:, j], stretches, samples, length, part)
    first = int(np.searchsorted(samples, part.start))
    return rows[first : first + part.stop - part.start]


def _within(stretches: np.ndarray, part: slice) -> np.ndarray:
    """Which stretches have samples in the part, as indices."""
    return np.flatnonzero((stretches[:, 0] < part.stop) & (stretches[:, 1] > part.start))


def _sides(
    chosen: np.ndarray, stretches: np.ndarray, length: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of the chosen stretches start and stop, and where their surroundings begin before and end after, (k,) each."""
    start, stop, beside = stretches.T
    before = np.maximum(start - beside, np.concatenate(([0], stop))[: len(stop)])
    after = np.minimum(stop + beside, length)
    return start[chosen], stop[chosen], before[chosen], after[chosen]


def _bridge(
    own: np.ndarray, stretches: np.ndarray, samples: np.ndarray, length: int, part: slice | None = None
) -> None:
    """Replace a joint's rows (K, ...) at the samples (K,) of a part (or of all) that lie in its stretches."""
    part = slice(0, length) if part is None else part
    chosen = _within(stretches, part)
    if not len(chosen) or not own.any():
        return
    start, stop, before, after = _sides(chosen, stretches, length)
    at_before, at_stop = np.searchsorted(samples, before), np.searchsorted(samples, stop)
    first = _means(own, at_before, at_before + start - before)
    second = _means(own, at_stop, at_stop + after - stop)
    has_first, has_second = before < start, stop < after
    y0, y1 = (
        np.where(_like(has, mine), mine, other)
        for has, mine, other in ((has_first, first, second), (has_second, second, first))
    )
    middles = 0.5 * (before + start - 1), 0.5 * (stop + after - 1)
    slope = (y1 - y0) / _like(middles[1] - middles[0], y0)
    inside, of = _ranges(np.maximum(start, part.start), np.minimum(stop, part.stop))
    some = (has_first | has_second)[of]
    inside, of = inside[some], of[some]
    own[np.searchsorted(samples, inside)] = y0[of] + _like(inside - middles[0][of], y0) * slope[of]


def _ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All samples of stretches from start (k,) to before stop (k,), one after the other, and whose they are."""
    length = np.maximum(stop - start, 0)
    of = np.repeat(np.arange(len(length)), length)
    return np.arange(len(of)) + (start - np.cumsum(length) + length)[of], of


def _means(values: np.ndarray, start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """The mean of values (N, ...) in each stretch under a Hann window, (k, ...); zero in one without samples."""
    samples, of = _ranges(start, stop)
    weights = np.sin(np.pi * (samples - start[of] + 0.5) / (stop - start)[of]) ** 2
    means = np.zeros((len(start), *values.shape[1:]))
    some = np.flatnonzero(stop > start)
    if len(some):
        first = np.searchsorted(of, some)
        weighted = values[samples] * _like(weights, values)
        means[some] = np.add.reduceat(weighted, first) / _like(np.add.reduceat(weights, first), means)
    return means


def _like(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Values (k,) with as many axes as rows (k, ...)."""
    return values.reshape(-1, *(1,) * (rows.ndim - 1))


def no_gaps(joints: int) -> Gaps:
    """No standstill anywhere."""
    return tuple(np.empty((0, 3), dtype=int) for _ in range(joints))


def moving_rows(gaps: Gaps, samples: int, decimation: int) -> np.ndarray:
    """Which decimated rows of which joints come from motion but for a small part, (M, n) True or False."""
    inside = np.zeros((samples, len(gaps)))
    for j, stretches in enumerate(gaps):
        for start, stop, _ in stretches:
            inside[start:stop, j] = 1.0
    return np.asarray(decimate(inside, decimation) < MOST)


def _stuck(velocity: np.ndarray, shortest: float) -> np.ndarray:
    """Whether any joint (of k) is slow for at least so many samples on end, (N,)."""
    found = np.zeros(len(velocity), dtype=bool)
    for v in np.ascontiguousarray(velocity.T):
        first, last = _runs(np.abs(v) <= SLOW * np.sqrt(v @ v / len(v)))
        long = last - first >= shortest
        found[_ranges(first[long], last[long])[0]] = True
    return found


def _runs(slow: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First sample, and one past the last, of every run of True in (N,)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], slow, [False])).astype(int)))
    return edges[::2], edges[1::2]


def _stretches(slow: np.ndarray, reach: int, beside: int) -> np.ndarray:
    """Runs of True (N,), each longer by `reach` at both ends; those with hardly a sample between them are one.

    beside: how many samples on either side tell of the surroundings.
    """
    runs: list[list[int]] = []
    for start, stop in zip(*_runs(slow), strict=True):
        first, last = max(int(start) - reach, 0), min(int(stop) + reach, len(slow))
        if runs and first - runs[-1][1] < reach:
            runs[-1][1] = last
        else:
            runs.append([first, last, beside])
    return np.array(runs, dtype=int).reshape(-1, 3)
