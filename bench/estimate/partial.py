"""What further columns would explain, without solving the whole system again (Frisch, Waugh and Lovell)."""

from dataclasses import dataclass

import numpy as np

from bench.estimate.absorbed import DEPENDENT
from bench.estimate.solution import Solution
from bench.estimate.stack import Stack


@dataclass(frozen=True)
class PartialRegression:
    """The linearised system of the currents' errors with all its columns taken out of everything else.

    The unknowns are [theta, g], or theta alone where the gains are fixed. basis (R, f): orthonormal, of the
    columns; remainder (R,): minus the weighted error; weights (n,): one over each motor's error in torque;
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
        """Least-squares coefficients (k,) of further columns, and the sum of squares that they explain.

        A column that the basis takes up explains nothing: what rounding leaves of it would, by chance.
        """
        rows = self.left(columns)
        norms = np.linalg.norm(rows, axis=0)
        sizes = np.linalg.norm(columns * (self.moving * self.weights)[:, :, None], axis=(0, 1))
        dependent = norms <= DEPENDENT * sizes
        rows[:, dependent], norms[dependent] = 0.0, 1.0
        values = np.linalg.lstsq(rows / norms, -self.remainder, rcond=1e-9)[0] / norms
        fitted = rows @ values
        return values, float(-self.remainder @ fitted)

    @property
    def sum_of_squares(self) -> float:
        """What is left of the right side, weighted."""
        return float(self.remainder @ self.remainder)


def partial_regression(stack: Stack, solution: Solution) -> PartialRegression:
    """Prepare the questions about a solved system, linearised about its current-domain `solution`.

    The residual is current - (phi theta + kappa) / g. A further column of torque enters divided by -g; one that
    only scales everything, as a known payload does, is in the span of phi and the gains' columns.
    """
    samples, n, p = stack.phi.shape
    modelled = (stack.phi @ solution.theta + stack.kappa) / solution.gains
    error = (stack.current - modelled) * stack.moving
    rms = np.sqrt((error**2).sum(axis=0) / np.maximum(stack.moving.sum(axis=0), 1))
    own = 1.0 / np.maximum(rms, 1e-12 * rms.max() + np.finfo(float).tiny)
    weights = own / solution.gains
    rows = np.zeros((samples, n, p + (n if solution.gains_fitted else 0)))
    rows[:, :, :p] = stack.phi * weights[:, None]
    if solution.gains_fitted:
        rows[:, np.arange(n), p + np.arange(n)] = -modelled * weights
    flat = (rows * stack.moving[:, :, None]).reshape(samples * n, -1)
    norms = np.linalg.norm(flat, axis=0)
    norms[norms == 0.0] = 1.0
    left, singular, _ = np.linalg.svd(flat / norms, full_matrices=False)
    basis = left[:, singular > 1e-10 * singular[0]]
    target = -(error * own).reshape(-1)
    remainder = target - basis @ (basis.T @ target)
    return PartialRegression(basis, remainder, weights, stack.moving)
