"""What further columns would explain, without solving the whole system again (Frisch, Waugh and Lovell)."""

from dataclasses import dataclass

import numpy as np

from bench.estimate.solution import Solution
from bench.estimate.stack import Stack


@dataclass(frozen=True)
class PartialRegression:
    """The linear system of the torque equations with all its columns taken out of everything else.

    The unknowns are [theta, g], or theta alone where the gains are fixed; rows are weighted by one over each
    motor's error. basis (R, f): orthonormal, of the columns; remainder (R,): of the right side; weights (n,);
    moving (M, n).
    """

    basis: np.ndarray
    remainder: np.ndarray
    weights: np.ndarray
    moving: np.ndarray

    def left(self, columns: np.ndarray) -> np.ndarray:
        """Columns (M, n, k) as weighted rows (R, k), without what the basis explains of them."""
        rows = (columns * (self.moving * self.weights)[:, :, None]).reshape(-1, columns.shape[2])
        return np.asarray(rows - self.basis @ (self.basis.T @ rows))

    def explained(self, columns: np.ndarray) -> tuple[np.ndarray, float]:
        """Least-squares coefficients (k,) of further columns, and the sum of squares that they explain."""
        rows = self.left(columns)
        norms = np.linalg.norm(rows, axis=0)
        norms[norms == 0.0] = 1.0
        values = np.linalg.lstsq(rows / norms, -self.remainder, rcond=1e-9)[0] / norms
        fitted = rows @ values
        return values, float(-self.remainder @ fitted)

    @property
    def sum_of_squares(self) -> float:
        """What is left of the right side, weighted."""
        return float(self.remainder @ self.remainder)


def partial_regression(stack: Stack, solution: Solution) -> PartialRegression:
    """Prepare the questions about a solved system; `solution` gives the weights and, where fixed, the gains.

    The residual is phi theta + kappa - diag(v) g: a further column of torque enters with a plus sign.
    """
    rms = torque_rms(stack, solution)
    weights = 1.0 / np.maximum(rms, 1e-12 * rms.max() + np.finfo(float).tiny)
    samples, n, p = stack.phi.shape
    gains = n if solution.gains_fitted else 0
    rows = np.zeros((samples, n, p + gains))
    rows[:, :, :p] = stack.phi
    right = stack.kappa
    if gains:
        rows[:, np.arange(n), p + np.arange(n)] = -stack.current
    else:
        right = right - stack.current * solution.gains
    flat = (rows * weights[:, None]).reshape(samples * n, -1)
    norms = np.linalg.norm(flat, axis=0)
    norms[norms == 0.0] = 1.0
    left, singular, _ = np.linalg.svd(flat / norms, full_matrices=False)
    basis = left[:, singular > 1e-10 * singular[0]]
    target = (right * weights).reshape(-1)
    remainder = target - basis @ (basis.T @ target)
    return PartialRegression(basis, remainder, weights, stack.moving)


def torque_rms(stack: Stack, solution: Solution) -> np.ndarray:
    """RMS torque error of every motor over the rows that are judged, (n,)."""
    error = stack.current * solution.gains - stack.phi @ solution.theta - stack.kappa
    count = np.maximum(stack.moving.sum(axis=0), 1)
    return np.asarray(np.sqrt((error**2 * stack.moving).sum(axis=0) / count))
