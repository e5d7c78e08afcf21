"""A bilinear system counted from a solution, so that many steps from there cost next to nothing."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from bench.identification.bilinear import creeps, errors_by, least, normal_equations, squares_of

INDEPENDENT = 1e-9  # least diagonal of the triangular factor of unit columns that it is divided by
DEPENDENT = 1e-13  # share of the largest singular value below which columns are dependent
WORSE = 1e-9  # relative growth of the cost that rounding may make
LEAST_SHARE = 1e-3  # of a step
FAR = 2.0  # times a gain: beyond, products are as inexact as the start is far


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
        fit_gains: bool,
        tolerance: float,
        most_steps: int,
        unseen: float = 0.0,
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Steps of Gauss and Newton with step halving, until the weighted cost falls by less than a share.

        unseen: the same, from which on it is enough that steps creep; see `creeps`.
        None where that is not so after so many steps, or gains are far from those that they are counted from.
        """
        squares, n = weights**2, len(gains)
        cost, last = float(self.squares(values, gains) @ squares), np.inf
        for _ in range(most_steps):
            both = least(*normal_equations(self.inner, values, gains, weights, self.gains, fit_gains))
            step, by_gain = both[: len(values)], both[len(values) :] if fit_gains else np.zeros(n)
            share = 1.0 / max(1.0, 2.0 * float(np.abs(by_gain / gains).max()))
            while True:
                new_values, new_gains = values + share * step, gains + share * by_gain
                new = float(self.squares(new_values, new_gains) @ squares)
                if new <= cost * (1.0 + WORSE):
                    break
                share /= 2.0
                if share < LEAST_SHARE:
                    return None
            converged = share == 1.0 and (
                cost - new <= tolerance * cost or creeps(cost - new, last, unseen * cost)
            )
            values, gains, cost, last = new_values, new_gains, new, cost - new
            ratio = gains / self.gains
            if ratio.max() > FAR or ratio.min() < 1.0 / FAR:
                return None
            if converged:
                return values, gains
        return None


def centred(factors: np.ndarray, theta: np.ndarray, gains: np.ndarray, weights: np.ndarray) -> Centred:
    """The system of factors (n, r, p + 2) of [phi, kappa, current] about a solution; weights (n,): of the errors."""
    p = len(theta)
    phi = factors[:, :, :p]
    torque = phi @ theta + factors[:, :, p]
    error = factors[:, :, p + 1] - torque / gains[:, None]
    basis = _orthonormal((phi * (weights / gains)[:, None, None]).reshape(-1, p))
    rows = np.concatenate((phi @ basis, torque[:, :, None], error[:, :, None]), axis=2)
    return Centred(rows.swapaxes(1, 2) @ rows, basis, theta, gains)


def _orthonormal(rows: np.ndarray) -> np.ndarray:
    """How columns (R, p) are combined to orthonormal ones of the same span, (p, b)."""
    lengths = np.linalg.norm(rows, axis=0)
    lengths[lengths == 0.0] = 1.0
    triangle = np.asarray(np.linalg.qr(rows / lengths, mode="r"))
    size = triangle.shape[1]
    if len(triangle) == size and np.abs(np.diag(triangle)).min(initial=1.0) > INDEPENDENT:
        return np.asarray(solve_triangular(triangle, np.eye(size), check_finite=False)) / lengths[:, None]
    _, singular, vectors = np.linalg.svd(triangle, full_matrices=False)
    kept = singular > DEPENDENT * singular.max(initial=0.0)
    return np.asarray(vectors[kept].T / singular[kept] / lengths[:, None])
