"""How many rows of correlated errors count as one.

If a motion returns, the model's error returns with it. Unlike noise, such an error does not average out over the
periods: rows a period apart are as correlated as neighbours.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from bench.basics.interpolation import cubic_spline
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES
from bench.signals.returning import lagged_products

Returns = Sequence[float | None]
"""For every recording, the period of its motion in rows; None where the motion does not return."""


def repeated_covariances(
    residual: np.ndarray, moving: np.ndarray, starts: Sequence[int], returns: Returns, covariances: np.ndarray
) -> np.ndarray | None:
    """Tapered autocovariances (L + 1,) of the repeating part of a motor's residual (M,); None where nothing repeats.

    Products of rows whole periods and up to L rows apart contain no noise. moving (M,): False where the residual is
    zero since the joint is at rest. covariances (L + 1,): of the residual itself.
    """
    lags = len(covariances) - 1
    pairs, counts = np.zeros(lags + 1), np.zeros(lags + 1)
    for rows, period in _recordings(starts, len(residual), returns):
        signals = np.column_stack((residual[rows], moving[rows]))
        sums = _whole_periods_apart(lagged_products(signals), period, lags)
        pairs += sums[:, 0]
        counts += sums[:, 1]
    if counts[0] < 1.0 or pairs[0] <= RULE.shows * covariances[0] * np.sqrt(counts[0]):
        return None
    mean = pairs / np.maximum(counts, 1.0)
    return np.asarray(mean * (1.0 - np.arange(lags + 1) / (lags + 1.0)))


def repeated_score(jacobian: np.ndarray, period: float, repeated: np.ndarray) -> np.ndarray:
    """J' Sigma J (P, P) for derivatives J (M, P) of one recording, with Sigma the covariances of rows whole periods
    apart: `repeated` (L + 1,), by the remaining lag.
    """
    samples = len(jacobian)
    at = np.arange(int(np.ceil(0.5 * period)), samples)
    off = np.abs(at - period * np.maximum(np.round(at / period), 1.0))
    known = np.concatenate((repeated[:0:-1], repeated, np.zeros(2)))
    course = cubic_spline(np.arange(len(known)) - (len(repeated) - 1.0), known)
    near = off < len(repeated)
    kernel = np.zeros(2 * samples)
    kernel[at[near]] = course(off[near])
    kernel[-at] = kernel[at]
    spectrum = np.fft.rfft(kernel).real
    total = np.zeros((jacobian.shape[1],) * 2)
    for k, column in enumerate(jacobian.T):
        spread = np.fft.irfft(np.fft.rfft(column, 2 * samples) * spectrum, 2 * samples)[:samples]
        total[:, k] = jacobian.T @ spread
    return np.asarray(0.5 * (total + total.T))


def times_repeated(errors: Sequence[np.ndarray], returns: Returns, reach: int) -> float:
    """How many rows of the errors (M, n) of all recordings count as one, correlated neighbours aside.

    Correlations of rows whole periods apart, summed like those of neighbours: 1 if errors do not return with the
    motion, the number of periods if they return unchanged. reach: rows over which neighbours correlate.
    """
    within = between = squares = count = pairs = 0.0
    for error, period in zip(errors, returns, strict=True):
        products = lagged_products(error).sum(axis=1)
        squares += float(products[0])
        count += error.size
        within += float(products[0] + 2.0 * products[1 : reach + 1].sum())
        if period is not None:
            sums = _whole_periods_apart(products[:, None], period, reach)[:, 0]
            pairs += float(sums[0])
            between += 2.0 * float(sums[0] + sums[1:].sum())
    if within <= 0.0 or pairs <= RULE.shows * squares / np.sqrt(count):
        return 1.0
    return 1.0 + max(between, 0.0) / within


def _whole_periods_apart(products: np.ndarray, period: float, reach: int) -> np.ndarray:
    """For products (M, k) by lag, their sums (reach + 1, k) at whole periods plus or minus 0 to reach rows.

    A spline interpolates between lags, since a period is not a whole number of rows.
    """
    last = len(products) - 1
    course = cubic_spline(np.arange(last + 1.0), products)
    sums = np.zeros((reach + 1, products.shape[1]))
    for off in range(min(reach, int(0.5 * period)) + 1):
        for side in (1, -1) if off else (1,):
            lags = np.arange(period, last + 1.0, period) + side * off
            sums[off] += course(lags[lags <= last]).sum(axis=0)
    return sums


def _recordings(starts: Sequence[int], rows: int, returns: Returns) -> Iterator[tuple[slice, float]]:
    """The rows of every recording whose motion returns, and its period in rows."""
    for a, b, period in zip(starts, (*starts[1:], rows), returns, strict=True):
        if period is not None:
            yield slice(a, b), period


def autocorrelation_time(errors: Sequence[np.ndarray], returns: Returns = ()) -> float:
    """Integrated autocorrelation time of the errors (M, n) of all recordings, in rows, at least one.

    Lags are summed until the correlation is lost in its noise (Geyer 1992, initial positive pairs), and likewise about
    whole periods of a motion that returns. returns: the period in rows of every recording; none: rows of different
    periods count as independent.
    """
    rows, reach = _local(errors)
    return rows * (times_repeated(errors, returns, reach) if returns else 1.0)


def repeats_of(errors: Sequence[np.ndarray], returns: Returns) -> float:
    """How many rows of different periods of the motion count as one; 1 where the errors do not return with it."""
    return times_repeated(errors, returns, _local(errors)[1])


def _local(errors: Sequence[np.ndarray]) -> tuple[float, int]:
    """How many consecutive rows count as one, and over how many lags they correlate."""
    length = min(len(error) for error in errors)
    lags = min(TOLERANCES.statistics.longest_memory, length // 4)
    values = np.array(
        [
            sum(float((error[: len(error) - lag] * error[lag:]).sum()) for error in errors)
            for lag in range(lags + 1)
        ]
    )
    if not values[0]:
        return 1.0, 0
    correlation = values / values[0]
    total, reach = 1.0, 0
    for lag in range(1, lags, 2):
        pair = correlation[lag] + correlation[lag + 1]
        if pair <= 0.0:
            break
        total += 2.0 * pair
        reach = lag + 1
    return max(float(total), 1.0), reach
