"""An inertia on a spring that a torque deflects."""

import numpy as np
from scipy.linalg import solve_banded

from bench.basics.interpolation import cubic_spline

FINER = 4  # samples for each given one: a torque is then nearly straight between two


def deflection(
    settled: np.ndarray, interval: float, squared_period: np.ndarray, damping: float
) -> np.ndarray:
    """How far a spring gives way (K, m): y + 2 damping T y' + T2 y'' = settled, with T2 = T T.

    settled: (K, m) where the spring would come to rest, `interval` s apart; squared_period: T2 (K,) s2, one over the
    square of the undamped angular frequency, above zero; damping: ratio, 0 to below 1. The spring starts at rest.
    Solved exactly for a `settled` that is straight and a T2 that is constant between fine samples.
    """
    time = interval * np.arange(len(settled))
    fine = interval / FINER * np.arange((len(settled) - 1) * FINER + 1)
    step = interval / FINER
    aim = cubic_spline(time, settled)(fine)
    slope = np.diff(aim, axis=0) / step
    period = np.sqrt(np.interp(fine[:-1] + 0.5 * step, time, squared_period))
    lag = 2.0 * damping * period[:, None] * slope
    transition = np.moveaxis(_swing(period, damping, step), 2, 0)  # how deviations from a line go on
    line = np.stack((aim[:-1] - lag, slope), axis=1)
    after = np.stack((aim[1:] - lag, slope), axis=1)
    given = after - transition @ line
    size = 2 * len(fine)
    band = np.zeros((4, size))
    band[0] = 1.0
    band[1, 1:-2:2] = -transition[:, 0, 1]
    band[2, :-2:2], band[2, 1:-2:2] = -transition[:, 0, 0], -transition[:, 1, 1]
    band[3, :-2:2] = -transition[:, 1, 0]
    right = np.concatenate((np.stack((aim[0], slope[0]))[None], given)).reshape(size, -1)
    return np.asarray(solve_banded((3, 0), band, right)[:: 2 * FINER])


def _swing(period: np.ndarray, damping: float, step: float) -> np.ndarray:
    """Position and velocity (2, 2, K) after a step of free swinging, by position and velocity before."""
    omega = 1.0 / period
    decay, swung = damping * omega, omega * np.sqrt(1.0 - damping**2)
    cos, sin = np.cos(swung * step), np.sin(swung * step) / swung
    decayed = np.exp(-decay * step)
    return np.asarray(decayed * np.array([[cos + decay * sin, sin], [-(omega**2) * sin, cos - decay * sin]]))
