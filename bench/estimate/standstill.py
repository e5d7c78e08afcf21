"""Where a joint stands still, friction takes any value up to its limit, and no sliding law holds.

What is logged there says nothing, and yet the low-pass of the fit spreads it over the rows around. So the
equations of a joint at standstill are replaced, before that filter, by the straight line between the equations
just before and just after: columns and current alike, which keeps every linear model true.
"""

import numpy as np

from bench.signals.decimation import decimate

SLOW = 0.01  # of the joint's RMS speed
SMEARED = 0.5  # cut-off periods of the position filter that a jump of the acceleration is spread over, on either side
START = 0.3  # of the RMS speed: slower at its first sample, a joint starts from rest
FIRST_WAY = 0.03  # of a joint's travel: before that, friction still depends on how the joint came to rest
HALF = 0.5  # of a row that may come from standstill before it is left aside

Gaps = tuple[np.ndarray, ...]
"""For each joint, the stretches (k, 3) of samples in which it stands still or reverses: the first, one past the
last, and how many on either side tell of its surroundings."""


def standstills(position: np.ndarray, velocity: np.ndarray, rate: float, cutoff: float) -> Gaps:
    """Stretches in which joints stand still, set off or reverse, before decimation.

    position, velocity (N, n), rad or m and their rates; rate Hz; cutoff of the position filter, Hz. A joint stands
    still where it is slower than 1 % of its RMS speed; reversals count however swift, and so does the first way
    of a joint that starts from rest. Stretches reach as far as the position filter spreads a jump.
    """
    reach = int(np.ceil(SMEARED * rate / cutoff))
    rms = np.sqrt((velocity**2).mean(axis=0))
    slow = np.abs(velocity) <= SLOW * rms
    slow[1:] |= velocity[1:] * velocity[:-1] < 0.0
    way = np.abs(position - position[0]) / np.maximum(np.ptp(position, axis=0), np.finfo(float).tiny)
    slow |= (np.maximum.accumulate(way, axis=0) < FIRST_WAY) & (np.abs(velocity[0]) < START * rms)
    return tuple(_stretches(slow[:, j], reach) for j in range(velocity.shape[1]))


def bridged(rows: np.ndarray, gaps: Gaps) -> np.ndarray:
    """Rows (N, n) or (N, n, p), those of every joint in its gaps replaced by a straight line; a copy.

    The line goes through the means of as many samples on either side as the position filter mixes.
    """
    rows = rows.copy()
    for j, stretches in enumerate(gaps):
        last = 0
        for start, stop, beside in stretches:
            sides = (slice(max(last, start - beside), start), slice(stop, min(stop + beside, len(rows))))
            last = stop
            means = [
                (0.5 * (side.start + side.stop - 1), rows[side, j].mean(axis=0))
                for side in sides
                if side.start < side.stop
            ]
            if means:
                (t0, y0), (t1, y1) = means[0], means[-1]
                share = (np.arange(start, stop) - t0) / (t1 - t0 or 1.0)
                rows[start:stop, j] = y0 + np.multiply.outer(share, y1 - y0)
    return rows


def no_gaps(joints: int) -> Gaps:
    """No standstill anywhere."""
    return tuple(np.empty((0, 3), dtype=int) for _ in range(joints))


def moving_rows(gaps: Gaps, samples: int, decimation: int) -> np.ndarray:
    """Which decimated rows of which joints come for the most part from motion, (M, n) True or False."""
    inside = np.zeros((samples, len(gaps)))
    for j, stretches in enumerate(gaps):
        for start, stop, _ in stretches:
            inside[start:stop, j] = 1.0
    return np.asarray(decimate(inside, decimation) < HALF)


def _stretches(slow: np.ndarray, reach: int) -> np.ndarray:
    """Runs of True (N,), each longer by `reach` at both ends; those with hardly a sample between them are one."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], slow, [False])).astype(int)))
    runs: list[list[int]] = []
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        first, last = max(int(start) - reach, 0), min(int(stop) + reach, len(slow))
        if runs and first - runs[-1][1] < reach:
            runs[-1][1] = last
        else:
            runs.append([first, last, 2 * reach])
    return np.array(runs, dtype=int).reshape(-1, 3)
