"""What no model explains: current noise, and errors that do not repeat when the motion does."""

from collections.abc import Sequence

import numpy as np

from bench.basics.interpolation import cubic_spline
from bench.diagnosis.system import System
from bench.identification.current_noise import current_noise
from bench.identification.decision import RULE
from bench.identification.prepare import Prepared
from bench.identification.result import CurrentSeries
from bench.identification.solve_only import solved_quickly, spread
from bench.identification.tolerances import TOLERANCES
from bench.signals.returning import rows_until_return, same_again


def noise_squares(prepared: Prepared) -> np.ndarray | None:
    """Sum of squares (n,) of each motor's current noise, drive units squared.

    Read off the spectra above the band of the motion, taken as white. None with redundant motors, whose current noise
    reaches the others through the loops.
    """
    if prepared.dataset.robot.redundant:
        return None
    total = np.zeros(len(prepared.present.gains))
    for measured, observation in zip(prepared.measured, prepared.observations, strict=True):
        if observation.use == "identify":
            variance = current_noise(measured.recording, prepared.settings) ** 2
            total += variance * observation.moving.sum(axis=0)
    return total


def leaves_only_noise(system: System, model: Prepared, noise: np.ndarray | None) -> bool:
    """Whether no effect could earn its place in a converged model: its residual on the fitted recordings has too few
    nats beyond the current `noise` (n,).
    """
    if noise is None:
        return False
    stack, solution = solved_quickly(model)
    weights = solution.weights**2
    residual = float((spread(stack, solution) ** 2 * stack.moving.sum(axis=0)) @ weights)
    least = float(noise @ weights)
    samples = system.fitted.rows / system.autocorrelation_time
    nats = 0.5 * samples * np.log(residual / max(least, np.finfo(float).tiny))
    return bool(TOLERANCES.statistics.white * least < residual and nats < RULE.prior)


def not_repeated(series: Sequence[CurrentSeries]) -> float | None:
    """RMS of the non-repeating part of all errors, over that of the currents there; None if no motion returns.

    Half of the squared difference of errors one period apart: noise, and whatever else does not follow the motion.
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
