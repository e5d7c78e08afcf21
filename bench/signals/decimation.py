"""Parallel filtering: the same decimation for every column of a linear model.

The identification model is y = W chi. Filtering y and every column of W by the same linear filter keeps
chi; so a low-pass that removes the noise above the band of the motion, and dropping the samples that are
then redundant, cost nothing. Source: M. Gautier, "Dynamic identification of robots with power model",
ICRA 1997; W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots", 2002, chapter 12.
The filter is the one of MATLAB's `decimate`, with which the EMPS results were published.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.block_filter import RunningFilter, kept_samples
from bench.signals.bounds import DECIMATING
from bench.signals.filtering import check_length, too_short
from bench.signals.sections import chebyshev, response

FloatArray = NDArray[np.float64]


def decimate(x: FloatArray, factor: int) -> FloatArray:
    """Filter every column alike with zero phase, then keep one sample in `factor`.

    The filter is a Chebyshev type I of order 8, ripple 0.05 dB, cut-off at 0.8 of half the new rate, run
    forward and backward along axis 0. The samples kept end with the last one (see `decimated_indices`).

    x: samples, shape (N, ...). factor: 1 returns a copy of x, unfiltered. Returns shape (ceil(N / factor), ...). Raises
    BenchError: factor below 1, or N not above 24.
    """
    kept = decimated_indices(len(x), factor)
    x = np.asarray(x, dtype=float)
    if factor == 1:
        return np.array(x)
    check_length(x, DECIMATING.order, f"decimation by {factor}")
    return kept_samples(sections_of(factor), x, DECIMATING.order, factor, int(kept[0]))


class Decimation:
    """`decimate` for samples that come in parts: none of them stays but what is kept."""

    def __init__(self, length: int, factor: int) -> None:
        """length: of all parts together. Raises BenchError as `decimate`."""
        first = int(decimated_indices(length, factor)[0])
        if factor > 1 and length <= 3 * DECIMATING.order:
            raise too_short(length, DECIMATING.order, f"decimation by {factor}")
        self._whole: list[FloatArray] = []
        self._filter = (
            None if factor == 1 else RunningFilter(sections_of(factor), DECIMATING.order, factor, first)
        )

    def push(self, x: FloatArray) -> None:
        """Take the next samples (K, C)."""
        if self._filter is None:
            self._whole.append(x)
        else:
            self._filter.push(x)

    def finish(self) -> FloatArray:
        """All kept samples (M, C), once there are no more."""
        return np.concatenate(self._whole) if self._filter is None else self._filter.finish()


def decimated_indices(length: int, factor: int) -> NDArray[np.intp]:
    """Return which of `length` samples `decimate` keeps, shape (ceil(length / factor),); the last is one."""
    if factor < 1:
        raise BenchError(f"decimation factor {factor} must be at least 1")
    return np.arange((length - 1) % factor, length, factor)


def fit_band(rate: float, factor: int) -> float:
    """Return the highest frequency [Hz] that `decimate` lets pass, for a sampling rate [Hz] before it."""
    return rate / 2 if factor == 1 else DECIMATING.band * rate / 2 / factor


@lru_cache(maxsize=64)
def noise_bandwidth(factor: int) -> float:
    """Return the share of the variance of white noise that `decimate` lets pass.

    It is the integral of the squared gain over all frequencies, close to 0.8 / factor.
    """
    if factor == 1:
        return 1.0
    frequency = np.linspace(0, min(2 * DECIMATING.band / factor, 1), 20001)
    h = response(sections_of(factor), np.pi * frequency)
    return float(np.trapezoid(np.abs(h) ** 4, frequency))


@lru_cache(maxsize=64)
def sections_of(factor: int) -> FloatArray:
    """Second-order sections (n_sections, 6) of one pass of the filter of `decimate`."""
    return chebyshev(DECIMATING.order, DECIMATING.ripple, DECIMATING.band / factor)
