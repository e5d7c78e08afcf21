"""Least squares of the currents' errors from inner products: unknown torques over unknown drive gains.

Every motor's rows are [columns, torque, error]: what the unknown values multiply, the torque that a solution needs that
they are counted from, and what it leaves of the current. With values x and gains g the current's error is
error + torque (1 / g0 - 1 / g) - columns x / g, and all that a step of Gauss and Newton needs of the rows are their
inner products. These are as exact as the solution is near: squares of what it leaves, none of the currents themselves.
"""

import numpy as np
from scipy.linalg.lapack import dposv, dpstrf

from bench.identification.solution import Fitted
from bench.identification.tolerances import TOLERANCES

TINY = float(np.finfo(float).tiny)


def normal_equations(
    inner: np.ndarray,
    values: np.ndarray,
    gains: np.ndarray,
    weights: np.ndarray,
    start: np.ndarray,
    fit_gains: Fitted,
) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and right side of a step of Gauss and Newton: values (..., k), then gains (..., n) where any is fitted;
    no step for those that are not.

    inner: (..., n, k + 2, k + 2) inner products; the leading axes are many problems. weights (n,): of
    the errors; start (n,): the gains that torque and error belong to.
    """
    k, n = values.shape[-1], gains.shape[-1]
    share = weights**2 / gains  # of torque in the weighted squares, with another of the gains to come
    by_error = (inner @ errors_by(values, gains, start)[..., None])[..., 0]
    right = (share[..., None, :] @ by_error[..., :k])[..., 0, :]
    flat = (share / gains)[..., None, :] @ inner.reshape(*inner.shape[:-2], -1)
    normal = flat.reshape(*gains.shape[:-1], k + 2, k + 2)[..., :k, :k]
    if not np.any(fit_gains):
        return normal, right
    torque = np.zeros((*gains.shape, k + 2))
    torque[..., :k], torque[..., k] = values[..., None, :], 1.0
    torque /= gains[..., None]
    torque *= np.reshape(fit_gains, (-1, 1))
    by_torque = (inner @ torque[..., None])[..., 0]
    across = -(share / gains)[..., None] * by_torque[..., :k]
    diagonal = np.where(fit_gains, share / gains * (torque * by_torque).sum(axis=-1), 1.0)[
        ..., None
    ] * np.eye(n)
    whole = np.empty((*gains.shape[:-1], k + n, k + n))
    whole[..., :k, :k], whole[..., k:, k:] = normal, diagonal
    whole[..., k:, :k], whole[..., :k, k:] = across, across.swapaxes(-1, -2)
    return whole, np.concatenate((right, -share * (torque * by_error).sum(axis=-1)), axis=-1)


def least(normal: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solution of normal equations, scaled to a unit diagonal; the smallest where they do not determine it."""
    diagonal = normal.diagonal()
    lengths = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = normal / lengths[:, None] / lengths
    factor, solution, failed = dposv(scaled, right / lengths, lower=1)
    if not failed and factor.diagonal().min(initial=1.0) > TOLERANCES.rank.pivot:
        return np.asarray(solution) / lengths
    values, vectors = np.linalg.eigh(scaled)
    kept = values > TOLERANCES.rank.pivot**2 * values[-1]
    along = vectors[:, kept]
    return np.asarray(along @ ((along.T @ (right / lengths)) / values[kept])) / lengths


def independent_of(inner: np.ndarray) -> np.ndarray:
    """Which of some columns of unit length, or none, are enough to span them all: indices, in order.

    From their inner products (k, k), by Cholesky's factorisation with the largest pivot first.
    """
    if not len(inner):
        return np.arange(0)
    _, pivots, rank, _ = dpstrf(inner, tol=TOLERANCES.rank.pivot**2, lower=1)
    return np.sort(pivots[:rank] - 1)


def creeps(fall: float, last: float, unseen: float) -> bool:
    """Whether steps lower the cost by less than `unseen` each and yet go on: along what the errors hardly tell."""
    return TOLERANCES.steps.creeping * last < fall <= unseen


def run_away(ratio: np.ndarray) -> np.ndarray:
    """Whether a gain has run away, so that a solution is of no use; ratio (..., n): of the gains to those they are
    counted from.
    """
    factor = TOLERANCES.steps.runaway_factor
    return np.asarray(~((ratio > 1.0 / factor) & (ratio < factor)).all(axis=-1))


def share_within_reach(gains: np.ndarray, by_gain: np.ndarray) -> np.ndarray:
    """Share (...) of a step of gains (..., n), and of all else with it, that changes none by more than a factor."""
    most = TOLERANCES.steps.gain_factor
    change = by_gain / gains
    up, down = change.max(axis=-1) / (1.0 - 1.0 / most), -change.min(axis=-1) / (most - 1.0)
    return np.asarray(1.0 / np.maximum(1.0, np.maximum(up, down)))


def moved_gains(gains: np.ndarray, by_gain: np.ndarray) -> np.ndarray:
    """Gains after a step: the errors follow their inverses in a line, so that these are what is moved."""
    return gains / (1.0 - by_gain / gains)


def errors_by(values: np.ndarray, gains: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Coefficients by which every motor's current error is combined from [columns, torque, error]: (..., n, k + 2)."""
    errors = np.ones((*gains.shape, values.shape[-1] + 2))
    errors[..., :-2] = -values[..., None, :] / gains[..., None]
    errors[..., -2] = 1.0 / start - 1.0 / gains
    return errors


def squares_of(inner: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Sum of squares (..., n) of what errors (..., n, k) combine, never below what rounding leaves of nothing."""
    combined = (inner @ errors[..., None])[..., 0]
    return np.asarray(np.maximum((errors * combined).sum(axis=-1), TINY))
