"""Where a joint stands still: there friction takes any value up to its limit, and no sliding law holds."""

import numpy as np

from bench.signals.decimation import decimated_indices

SLOW = 0.01  # of the joint's RMS speed
LASTING = 0.008  # s; a shorter slow stretch is a swift reversal
REACH = 2  # decimated samples to either side that the low-pass of the fit mixes in


def moving_rows(velocity: np.ndarray, rate: float, decimation: int) -> np.ndarray:
    """Which decimated rows of which joints are far from any standstill, (M, n) True or False.

    velocity (N, n) before decimation, rad/s or m/s; rate Hz. A joint stands still where it is slower than 1 %
    of its RMS speed for longer than 8 ms.
    """
    rms = np.sqrt((velocity**2).mean(axis=0))
    slow = np.abs(velocity) <= SLOW * rms
    kept = decimated_indices(len(velocity), decimation)
    moving = np.ones((len(kept), velocity.shape[1]), dtype=bool)
    for j in range(velocity.shape[1]):
        edges = np.flatnonzero(np.diff(np.concatenate(([False], slow[:, j], [False])).astype(int)))
        for start, stop in zip(edges[::2], edges[1::2], strict=True):
            if stop - start <= LASTING * rate:
                continue
            first = np.searchsorted(kept, start - REACH * decimation)
            last = np.searchsorted(kept, stop - 1 + REACH * decimation, side="right")
            moving[first:last, j] = False
    return moving
