"""Zero-phase low-pass filter of measured joint positions.

Source: the band-pass differentiation of M. Gautier, "Dynamic identification of robots with power model",
ICRA 1997: a Butterworth filter run forward and backward, followed by central differences. The ends are
extended as MATLAB's `filtfilt` does, so that published results can be repeated to the last digit.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.sections import at_rest, butterworth, filtered

FloatArray = NDArray[np.float64]


def low_pass(x: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Return x without what lies above the cut-off, with no phase shift.

    A Butterworth filter runs forward and then backward along axis 0, so its gain is squared:
    1 / (1 + (tan(pi f / rate) / tan(pi cutoff / rate))^(2 order)), one half at the cut-off. Both ends are
    extended by 3 * order samples, reflected through the end points.

    x: samples, shape (N, ...), any unit; every column is filtered alike. rate: sampling rate [Hz]. cutoff: cut-off
    frequency [Hz], below half the sampling rate. order: order of one pass. Raises BenchError: the cut-off is not
    between 0 and half the sampling rate, or the record is too short.
    """
    if order < 1:
        raise BenchError(f"low-pass filter: order {order} must be at least 1")
    if not 0 < cutoff < rate / 2:
        raise BenchError(
            f"low-pass filter: cut-off {cutoff:g} Hz must lie between 0 and {rate / 2:g} Hz, "
            f"half the sampling rate of {rate:g} Hz"
        )
    return forward_backward(_butterworth(order, 2.0 * cutoff / rate), x, order, "low-pass filter")


def low_pass_gain(frequency: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Return the gain of `low_pass` (forward and backward together) at frequencies [Hz] up to rate / 2."""
    warped = np.tan(np.pi * np.asarray(frequency) / rate) / np.tan(np.pi * cutoff / rate)
    return np.asarray(1 / (1 + warped ** (2 * order)), dtype=float)


def forward_backward(sections: FloatArray, x: FloatArray, order: int, what: str) -> FloatArray:
    """Run second-order sections forward and backward along axis 0, ends extended by 3 * order samples.

    Second-order sections and not one ratio of polynomials: at a cut-off of a twelfth of the rate the two
    already differ by 2e-8, and the polynomials lose more the lower the cut-off is.

    sections: shape (n_sections, 6). x: samples, shape (N, ...). order: order of the filter, which sets the length of
    the extension. what: name of the caller for the message. Raises BenchError: the record has no more than 3 * order
    samples.
    """
    x = np.asarray(x, dtype=float)
    check_length(x, order, what)
    start = resting_states(sections.tobytes())[(..., *(None,) * (x.ndim - 1))]
    way = extended_end(extended_start(x, 3 * order), 3 * order)
    for _ in range(2):
        way = filtered(sections, way, start * way[0])[0][::-1]
    return np.ascontiguousarray(way[3 * order : len(way) - 3 * order])


def check_length(x: FloatArray, order: int, what: str) -> None:
    """Raise BenchError where a record (N, ...) is too short for the extension of a filter of this order."""
    if len(x) <= 3 * order:
        raise too_short(len(x), order, what)


def too_short(length: int, order: int, what: str) -> BenchError:
    """What is said of a record of so many samples."""
    return BenchError(f"{what}: {length} samples are too few, it needs more than {3 * order}")


def extended_start(x: FloatArray, length: int, held: int = 0) -> FloatArray:
    """Return x, shape (N, ...), with so many samples more before it, reflected through the first one.

    held: how many more samples stand before all of them, equal to the first of them.
    """
    start = held + length
    extended = np.empty((start + len(x), *x.shape[1:]))
    extended[start:] = x
    np.subtract(2 * x[0], x[length:0:-1], out=extended[held:start])
    extended[:held] = extended[held]
    return extended


def extended_end(x: FloatArray, length: int) -> FloatArray:
    """Return x, shape (N, ...), with so many samples more after it, reflected through the last one."""
    extended = np.empty((len(x) + length, *x.shape[1:]))
    extended[: len(x)] = x
    np.subtract(2 * x[-1], x[-2 : -length - 2 : -1], out=extended[len(x) :])
    return extended


@lru_cache(maxsize=64)
def _butterworth(order: int, cutoff: float) -> FloatArray:
    """Second-order sections of a low-pass, its cut-off as a share of half the rate."""
    return butterworth(order, cutoff)


@lru_cache(maxsize=64)
def resting_states(sections: bytes) -> FloatArray:
    """States (n_sections, 2) of second-order sections that have seen ones for ever."""
    return at_rest(np.frombuffer(sections).reshape(-1, 6))
