"""Motion that returns: the period in samples of positions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.basics.interpolation import cubic_spline
from bench.signals.bounds import RETURNING

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Course:
    """A motion's positions (M, n); their period in samples is computed once."""

    position: FloatArray

    @cached_property
    def returns(self) -> float | None:
        """See `rows_until_return`."""
        return rows_until_return(self.position)


def rows_until_return(position: FloatArray) -> float | None:
    """The shortest lag, in fractional samples, after which positions (M, n) are mostly the same; None if none."""
    spread = position.std(axis=0)
    turning = spread > 0.0
    if not turning.any() or len(position) <= RETURNING.samples:
        return None
    scaled = position[:, turning] / spread[turning]
    by_row = shifted_apart(scaled)[1 : len(position) - RETURNING.samples].max(axis=1)
    gone = np.flatnonzero(by_row > RETURNING.other)
    if not len(gone):
        return None
    inner = by_row[1:-1]
    least = 1 + np.flatnonzero((inner <= by_row[:-2]) & (inner <= by_row[2:]) & (inner < RETURNING.near))
    for i in (1 + least[least > gone[0]]).tolist():
        # as far as a fraction of a sample can change it
        pace = np.abs(np.diff(scaled[i - 1 :], axis=0)).max(axis=1)
        off = np.abs(scaled[i:] - scaled[: len(scaled) - i]).max(axis=1)
        if np.mean(off <= RETURNING.same + pace) <= RETURNING.mostly:
            continue
        best, reach = float(i), 1.0
        for step in RETURNING.steps:
            tried = best + step * np.arange(-round(reach / step), round(reach / step) + 1)
            mostly = [float(np.median(apart)) for apart in _apart(scaled, tried.tolist())]
            best, reach = float(tried[np.argmin(mostly)]), step
        if min(mostly) <= RETURNING.same:
            return best
    return None


def same_again(position: FloatArray, lag: float) -> NDArray[np.bool_]:
    """Whether the positions (M, n) are the same after `lag` samples, for all samples (K,) with such a later one."""
    spread = position.std(axis=0)
    (apart,) = _apart(position / np.where(spread > 0.0, spread, np.inf), [lag])
    return np.asarray(apart <= RETURNING.same)


def _apart(scaled: FloatArray, lags: Sequence[float]) -> Iterator[FloatArray]:
    """Largest distance (K,) of signals (M, n) from themselves after each of the lags."""
    rows = np.arange(len(scaled), dtype=float)
    course = cubic_spline(rows, scaled)
    for lag in lags:
        known = rows[rows <= rows[-1] - lag]
        yield np.abs(course(known + lag) - scaled[: len(known)]).max(axis=1)


def shifted_apart(signals: FloatArray) -> FloatArray:
    """RMS distance (M, n) of signals (M, n) from themselves, shifted by 0 to M - 1 samples, from their spectrum."""
    signals = signals - signals.mean(axis=0)
    rows = len(signals)
    products = lagged_products(signals)
    squares = np.cumsum(signals**2, axis=0)[::-1]  # of the first M - k samples, at k
    ends = np.cumsum(signals[::-1] ** 2, axis=0)[::-1]  # of the last M - k samples
    count = np.arange(rows, 0, -1)[:, None]
    return np.asarray(np.sqrt(np.maximum(squares + ends - 2.0 * products, 0.0) / count))


def lagged_products(signals: FloatArray) -> FloatArray:
    """Inner products (M, n) of signals (M, n) with themselves, shifted by 0 to M - 1 samples."""
    rows = len(signals)
    spectrum = np.fft.rfft(signals, 2 * rows, axis=0)
    return np.asarray(np.fft.irfft((spectrum * spectrum.conj()).real, 2 * rows, axis=0)[:rows])
