"""How many rows of errors that are alike count as one."""

from collections.abc import Sequence

import numpy as np

from bench.identification.repeated_errors import Returns, times_repeated
from bench.identification.tolerances import TOLERANCES


def autocorrelation_time(errors: Sequence[np.ndarray], returns: Returns = ()) -> float:
    """Integrated autocorrelation time of the errors (M, n) of all recordings, in rows, at least one.

    Lags are summed until the correlation is lost in its noise (Geyer 1992, initial positive pairs), and likewise
    about whole periods of a motion that returns. returns: after how many rows it does, for every recording; none: rows
    of different periods count as different.
    """
    rows, reach = _local(errors)
    return rows * (times_repeated(errors, returns, reach) if returns else 1.0)


def repeats_of(errors: Sequence[np.ndarray], returns: Returns) -> float:
    """How many rows of different periods of the motion count as one; 1 where the errors do not return with it."""
    return times_repeated(errors, returns, _local(errors)[1])


def _local(errors: Sequence[np.ndarray]) -> tuple[float, int]:
    """How many rows that follow each other count as one, and over how many lags they are alike."""
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
