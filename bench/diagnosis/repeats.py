"""What logs do not repeat where their motion repeats itself: no model of that motion explains it."""

from collections.abc import Sequence

import numpy as np

from bench.basics.interpolation import cubic_spline
from bench.identification.result import CurrentSeries
from bench.signals.returning import rows_until_return, same_again


def not_repeated(series: Sequence[CurrentSeries]) -> float | None:
    """RMS of what the errors of all series do not repeat, over that of the currents there; None if no motion returns.

    Half of the squared difference of the errors one period apart: noise, and whatever else the motion does not decide.
    """
    squares = measured = 0.0
    for trace in series:
        rows = rows_until_return(trace.position)
        if rows is None:
            continue
        period = rows * float(trace.time[-1] - trace.time[0]) / (len(trace.time) - 1)
        again = same_again(trace.position, rows)
        known = np.arange(len(trace.time)) < len(again)
        later = trace.time[known] + period
        still = cubic_spline(trace.time, trace.moving.astype(float))(later) <= 1.0 - 1e-6
        both = again[:, None] & trace.moving[known] & ~still
        apart = (cubic_spline(trace.time, trace.error)(later) - trace.error[known]) * both
        squares += 0.5 * float((apart**2).sum())
        measured += float(((trace.measured[known] * both) ** 2).sum())
    return float(np.sqrt(squares / measured)) if measured else None
