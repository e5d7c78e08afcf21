"""What logs do not repeat where their motion repeats itself: no model of that motion explains it."""

from collections.abc import Sequence

import numpy as np

from bench.identification.result import CurrentSeries

SAME = 0.1  # of the deviation of a position: as far a motion that returns may be from what it was
OTHER = 0.5  # of it: as far it must have been in between
FEWEST = 30  # rows that are there a second time
FINER = 20  # places between two rows at which a period is looked for


def not_repeated(series: Sequence[CurrentSeries]) -> float | None:
    """RMS of what the errors of all series do not repeat, over that of the currents there; None if no motion returns.

    Half of the squared difference of the errors one period apart: noise, and whatever else the motion does not decide.
    """
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 - slow to import, and seldom needed

    left = measured = 0.0
    for trace in series:
        period = _period(trace.time, trace.position)
        if period is None:
            continue
        known = trace.time <= trace.time[-1] - period
        later = trace.time[known] + period
        both = trace.moving[known] & (CubicSpline(trace.time, trace.moving.astype(float))(later) > 1.0 - 1e-6)
        apart = (CubicSpline(trace.time, trace.error)(later) - trace.error[known]) * both
        left += 0.5 * float((apart**2).sum())
        measured += float(((trace.measured[known] * both) ** 2).sum())
    return float(np.sqrt(left / measured)) if measured else None


def _period(time: np.ndarray, position: np.ndarray) -> float | None:
    """The shortest time after which positions (M, n) are the same again, s; None where they are not."""
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 - slow to import, and seldom needed

    spread = position.std(axis=0)
    turning = spread > 0.0
    if not turning.any() or len(time) <= FEWEST:
        return None
    scaled = position[:, turning] / spread[turning]
    step = float(time[-1] - time[0]) / (len(time) - 1)

    def apart(lag: float) -> float:
        known = time <= time[-1] - lag
        return float(np.sqrt(((course(time[known] + lag) - scaled[known]) ** 2).mean(axis=0)).max())

    lags = np.arange(1, len(time) - FEWEST)
    by_row = _shifted_apart(scaled)[lags].max(axis=1)
    gone = np.flatnonzero(by_row > OTHER)
    if not len(gone):
        return None
    least = [
        i
        for i in range(int(gone[0]) + 1, len(lags) - 1)
        if by_row[i] <= min(by_row[i - 1], by_row[i + 1]) and by_row[i] < OTHER
    ]
    course = CubicSpline(time, scaled)
    for i in least:
        tried = step * (lags[i] + np.linspace(-1.0, 1.0, 2 * FINER + 1))
        best = min(tried.tolist(), key=apart)
        if apart(best) < SAME:
            return best
    return None


def _shifted_apart(signals: np.ndarray) -> np.ndarray:
    """RMS distance (M, n) of signals (M, n) from themselves, shifted by 0 to M - 1 rows, by way of their spectrum."""
    signals = signals - signals.mean(axis=0)
    rows = len(signals)
    spectrum = np.fft.rfft(signals, 2 * rows, axis=0)
    products = np.fft.irfft(spectrum * spectrum.conj(), 2 * rows, axis=0)[:rows]
    squares = np.cumsum(signals**2, axis=0)[::-1]  # of the first M - k rows, at k
    ends = np.cumsum(signals[::-1] ** 2, axis=0)[::-1]  # of the last M - k rows
    count = np.arange(rows, 0, -1)[:, None]
    return np.asarray(np.sqrt(np.maximum(squares + ends - 2.0 * products, 0.0) / count))
