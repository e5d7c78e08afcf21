"""A bilinear system counted from a solution, so that many steps from there cost next to nothing."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import solve_triangular

from bench.identification.bilinear import creeps, errors_by, least, normal_equations, squares_of
from bench.identification.solution import Fitted
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Reached:
    """Where steps have led, values (b,) and gains (n,), and why they ended there: the cost hardly falls any more, the
    gains are far from those that they are counted from, or no part of the next step lowers the cost.
    """

    values: np.ndarray
    gains: np.ndarray
    why: Literal["converged", "far", "stuck"]


@dataclass(frozen=True)
class Centred:
    """Inner products (n, b + 2, b + 2) of every motor's [columns, torque, error]; see bench.identification.bilinear.

    basis (p, b): how the columns of phi are combined to nearly orthonormal ones; theta (p,) and gains (n,): the
    solution that values (b,) are counted from.
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
        """Steps of Gauss and Newton with step halving, until the weighted cost falls by less than a share.

        unseen: the same, from which on it is enough that steps creep; see `creeps`.
        None where the cost still falls after so many steps.
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
    """Products of factors (n, r, p + 2), with columns that are orthonormal where motors count by scale (n,)."""
    phi = factors[:, :, :-2]
    basis = _orthonormal((phi * scale[:, None, None]).reshape(-1, phi.shape[2]))
    columns = phi @ basis
    return FactorProducts(factors, basis, columns, columns.swapaxes(1, 2) @ columns)


def _orthonormal(rows: np.ndarray) -> np.ndarray:
    """How columns (R, p) are combined to orthonormal ones of the same span, (p, b)."""
    lengths = np.linalg.norm(rows, axis=0)
    lengths[lengths == 0.0] = 1.0
    triangle = np.asarray(np.linalg.qr(rows / lengths, mode="r"))
    size = triangle.shape[1]
    if len(triangle) == size and np.abs(np.diag(triangle)).min(initial=1.0) > TOLERANCES.rank.triangle:
        return np.asarray(solve_triangular(triangle, np.eye(size), check_finite=False)) / lengths[:, None]
    _, singular, vectors = np.linalg.svd(triangle, full_matrices=False)
    kept = singular > TOLERANCES.rank.columns * singular.max(initial=0.0)
    return np.asarray(vectors[kept].T / singular[kept] / lengths[:, None])
