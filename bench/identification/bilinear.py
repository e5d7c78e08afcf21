"""Least squares of the currents' errors from inner products: unknown torques over unknown drive gains.

Every motor's rows are [columns, torque, error]: the columns that the unknown values multiply, and the torque and
current error of a reference solution from which the values are counted. With values x and gains g the current's error
is error + torque (1 / g0 - 1 / g) - columns x / g, and a Gauss-Newton step needs only the rows' inner products. These
are the more exact the nearer the reference is: they hold squares of its error, not of the currents.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import solve_triangular
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
    """Matrix and right side of a Gauss-Newton step: values (..., k), then gains (..., n) if any is fitted; the others
    do not move.

    inner: (..., n, k + 2, k + 2) inner products; leading axes are separate problems. weights (n,): of the errors; start
    (n,): the gains that torque and error belong to.
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
    """Solution of normal equations, scaled to a unit diagonal; of minimum norm where they are singular."""
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
    """Indices, in order, of columns of unit (or zero) length that span all columns.

    From their inner products (k, k), by Cholesky's factorisation with the largest pivot first.
    """
    if not len(inner):
        return np.arange(0)
    _, pivots, rank, _ = dpstrf(inner, tol=TOLERANCES.rank.pivot**2, lower=1)
    return np.sort(pivots[:rank] - 1)


def creeps(fall: float, last: float, unseen: float) -> bool:
    """Whether steps creep: each lowers the cost by less than `unseen`, in a hardly determined direction."""
    return TOLERANCES.steps.creeping * last < fall <= unseen


def run_away(ratio: np.ndarray) -> np.ndarray:
    """Whether a gain has run away, so that a solution is useless; ratio (..., n): of the gains to those of the
    reference.
    """
    factor = TOLERANCES.steps.runaway_factor
    return np.asarray(~((ratio > 1.0 / factor) & (ratio < factor)).all(axis=-1))


def share_within_reach(gains: np.ndarray, by_gain: np.ndarray) -> np.ndarray:
    """Share (...) of a whole step at which no gain (..., n) changes by more than a factor."""
    most = TOLERANCES.steps.gain_factor
    change = by_gain / gains
    up, down = change.max(axis=-1) / (1.0 - 1.0 / most), -change.min(axis=-1) / (most - 1.0)
    return np.asarray(1.0 / np.maximum(1.0, np.maximum(up, down)))


def moved_gains(gains: np.ndarray, by_gain: np.ndarray) -> np.ndarray:
    """Gains after a step, which moves their inverses, since the errors are linear in these."""
    return gains / (1.0 - by_gain / gains)


def errors_by(values: np.ndarray, gains: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Coefficients by which every motor's current error is combined from [columns, torque, error]: (..., n, k + 2)."""
    errors = np.ones((*gains.shape, values.shape[-1] + 2))
    errors[..., :-2] = -values[..., None, :] / gains[..., None]
    errors[..., -2] = 1.0 / start - 1.0 / gains
    return errors


def squares_of(inner: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Sum of squares (..., n) of the errors with coefficients (..., n, k), never below the rounding error."""
    combined = (inner @ errors[..., None])[..., 0]
    return np.asarray(np.maximum((errors * combined).sum(axis=-1), TINY))


@dataclass(frozen=True)
class Reached:
    """Where steps ended, values (b,) and gains (n,), and why: the cost hardly falls any more, the gains are far from
    those of the reference, or no part of the next step lowers the cost.
    """

    values: np.ndarray
    gains: np.ndarray
    why: Literal["converged", "far", "stuck"]


@dataclass(frozen=True)
class Centred:
    """Inner products (n, b + 2, b + 2) of every motor's [columns, torque, error]; see bench.identification.bilinear.

    basis (p, b): combines the columns of phi to nearly orthonormal ones; theta (p,) and gains (n,): the reference
    solution, where values (b,) are zero.
    """

    inner: np.ndarray
    basis: np.ndarray
    theta: np.ndarray
    gains: np.ndarray

    def theta_at(self, values: np.ndarray) -> np.ndarray:
        """Theta (p,) for values (b,)."""
        return self.theta + self.basis @ values

    def squares(self, values: np.ndarray, gains: np.ndarray) -> np.ndarray:
        """Sum of squares (n,) of every motor's current error."""
        return squares_of(self.inner, errors_by(values, gains, self.gains))

    def minimised(
        self,
        values: np.ndarray,
        gains: np.ndarray,
        weights: np.ndarray,
        fit_gains: Fitted,
        tolerance: float,
        most_steps: int,
        unseen: float = 0.0,
    ) -> Reached | None:
        """Gauss-Newton steps with step halving, until the relative decrease of the weighted cost is below `tolerance`.

        unseen: decrease below which creeping steps end, too; see `creeps`. None if the cost still falls after
        `most_steps`.
        """
        bounds, squares, n = TOLERANCES.steps, weights**2, len(gains)
        cost, last = float(self.squares(values, gains) @ squares), np.inf
        for _ in range(most_steps):
            both = least(*normal_equations(self.inner, values, gains, weights, self.gains, fit_gains))
            step, by_gain = both[: len(values)], both[len(values) :] if np.any(fit_gains) else np.zeros(n)
            share = 1.0 / max(1.0, 2.0 * float(np.abs(by_gain / gains).max()))
            while True:
                new_values, new_gains = values + share * step, gains + share * by_gain
                new = float(self.squares(new_values, new_gains) @ squares)
                if new <= cost * (1.0 + bounds.rounding):
                    break
                share /= 2.0
                if share < bounds.least_share:
                    return Reached(values, gains, "stuck")
            fall = cost - new
            converged = share == 1.0 and (fall <= tolerance * cost or creeps(fall, last, unseen * cost))
            values, gains, cost, last = new_values, new_gains, new, fall
            ratio = gains / self.gains
            far = bool(ratio.max() > bounds.recentred_factor or ratio.min() < 1.0 / bounds.recentred_factor)
            if converged or far:
                return Reached(values, gains, "far" if far and fall > bounds.endless * cost else "converged")
        return None


@dataclass(frozen=True)
class FactorProducts:
    """Factors (n, r, p + 2) of [phi, kappa, current] whose columns of phi are combined, by a basis (p, b), to nearly
    orthonormal ones: these columns (n, r, b), and their inner products (n, b, b), motor by motor.
    """

    factors: np.ndarray
    basis: np.ndarray
    columns: np.ndarray
    inner: np.ndarray

    def about(self, theta: np.ndarray, gains: np.ndarray) -> Centred:
        """The system counted from a solution."""
        p, b = len(theta), self.basis.shape[1]
        torque = self.factors[:, :, :p] @ theta + self.factors[:, :, p]
        error = self.factors[:, :, p + 1] - torque / gains[:, None]
        rows = np.stack((torque, error), axis=2)
        inner = np.empty((len(gains), b + 2, b + 2))
        inner[:, :b, :b] = self.inner
        inner[:, :b, b:] = self.columns.swapaxes(1, 2) @ rows
        inner[:, b:, :b] = inner[:, :b, b:].swapaxes(1, 2)
        inner[:, b:, b:] = rows.swapaxes(1, 2) @ rows
        return Centred(inner, self.basis, theta, gains)


def products_of(factors: np.ndarray, scale: np.ndarray) -> FactorProducts:
    """Products of factors (n, r, p + 2); their columns are orthonormal if motors are weighted by scale (n,)."""
    phi = factors[:, :, :-2]
    basis = _orthonormal((phi * scale[:, None, None]).reshape(-1, phi.shape[2]))
    columns = phi @ basis
    return FactorProducts(factors, basis, columns, columns.swapaxes(1, 2) @ columns)


def _orthonormal(rows: np.ndarray) -> np.ndarray:
    """Matrix (p, b) that makes columns (R, p) orthonormal, of the same span."""
    lengths = np.linalg.norm(rows, axis=0)
    lengths[lengths == 0.0] = 1.0
    triangle = np.asarray(np.linalg.qr(rows / lengths, mode="r"))
    size = triangle.shape[1]
    if len(triangle) == size and np.abs(np.diag(triangle)).min(initial=1.0) > TOLERANCES.rank.triangle:
        return np.asarray(solve_triangular(triangle, np.eye(size), check_finite=False)) / lengths[:, None]
    _, singular, vectors = np.linalg.svd(triangle, full_matrices=False)
    kept = singular > TOLERANCES.rank.columns * singular.max(initial=0.0)
    return np.asarray(vectors[kept].T / singular[kept] / lengths[:, None])
