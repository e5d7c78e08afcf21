"""Autocorrelation of errors, and how many rows count as one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.identification.tolerances import TOLERANCES
from bench.residuals.motor import MotorSeries


@dataclass(frozen=True, eq=False)
class Autocorrelation:
    """lag (L,) s; value (L,), one at lag zero; band: 95 % of the values lie within ± band by chance.

    integrated_time: the integrated autocorrelation time, the number of rows that count as one.
    """

    lag: np.ndarray
    value: np.ndarray
    band: float
    integrated_time: float


def autocorrelation(series: Sequence[MotorSeries]) -> Autocorrelation:
    """Autocorrelation of one motor's error over all recordings; gaps at standstill are omitted."""
    values = correlations([trace.row for trace in series], [trace.error for trace in series])
    count = sum(len(trace.time) for trace in series)
    rate = series[0].rate or 1.0
    lag = np.arange(len(values)) / rate
    band = WITHIN_95 / float(np.sqrt(max(count, 1)))
    return Autocorrelation(lag, values, band, integrated_autocorrelation_time(values))


def correlations(rows: Sequence[np.ndarray], values: Sequence[np.ndarray]) -> np.ndarray:
    """Correlation of values at lags of 0, 1, 2 ... rows (at most 61,).

    rows: index of each value among evenly spaced rows, rising, some missing. The mean counts as error; each lag's
    products are divided by the power of their values, so that no correlation exceeds one.
    """
    lags = max(min(TOLERANCES.statistics.longest_memory, min(len(column) for column in rows) // 4), 1)
    sums, powers = np.zeros(lags + 1), np.zeros((2, lags + 1))
    for row, value in zip(rows, values, strict=True):
        length = int(row[-1] - row[0]) + 1
        filled, there = np.zeros(length), np.zeros(length)
        filled[row - row[0]], there[row - row[0]] = value, 1.0
        for lag in range(min(lags, length - 1) + 1):
            sums[lag] += filled[: length - lag] @ filled[lag:]
            powers[0, lag] += filled[: length - lag] ** 2 @ there[lag:]
            powers[1, lag] += there[: length - lag] @ filled[lag:] ** 2
    scale = np.sqrt(powers[0] * powers[1])
    if not sums[0] > 0:
        return np.eye(1, lags + 1)[0]
    return np.divide(sums, scale, out=np.zeros(lags + 1), where=scale > 0)


def integrated_autocorrelation_time(correlation: np.ndarray) -> float:
    """Integrated autocorrelation time in rows, at least one.

    Lags are summed in pairs until the correlation is lost in its noise (Geyer, "Practical Markov chain Monte
    Carlo", 1992: initial positive sequence).
    """
    total = 1.0
    for lag in range(1, len(correlation) - 1, 2):
        pair = float(correlation[lag] + correlation[lag + 1])
        if pair <= 0.0:
            break
        total += 2.0 * pair
    return max(total, 1.0)


def independent_rows(series: Sequence[MotorSeries], values: Sequence[np.ndarray]) -> float:
    """Number of independent rows, for one value per row."""
    rows = [trace.row for trace in series]
    return sum(map(len, values)) / integrated_autocorrelation_time(correlations(rows, values))
