"""What further columns would explain, without solving the whole system again (Frisch, Waugh and Lovell)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.estimate.solution import Solution
from bench.estimate.stack import Stack

ROUNDING = 1e-6  # share of a column's length: inner products tell no less from nothing
COLLINEAR = 1e-12  # of the largest singular value of inner products of unit columns


@dataclass(frozen=True)
class Products:
    """Of columns of which only what is left beside others counts: inner products (k, k), those with what is to be
    explained (k,), and the lengths (k,) of the whole columns.
    """

    inner: np.ndarray
    towards: np.ndarray
    lengths: np.ndarray

    @property
    def left(self) -> np.ndarray:
        """Share (k,) of every column's length that is left."""
        left = np.sqrt(np.maximum(np.diag(self.inner), 0.0))
        return np.divide(left, self.lengths, out=np.zeros_like(left), where=self.lengths > 0.0)

    def explained(self) -> tuple[np.ndarray, float]:
        """Least-squares coefficients (k,), and the sum of squares that they explain.

        A column of which nothing is left explains nothing: what rounding leaves of it would, by chance.
        """
        values = np.zeros(len(self.towards))
        kept = np.flatnonzero(self.left > ROUNDING)
        if not len(kept):
            return values, 0.0
        norms = np.sqrt(np.diag(self.inner)[kept])
        normal = self.inner[np.ix_(kept, kept)] / np.outer(norms, norms)
        right = self.towards[kept] / norms
        found = np.linalg.lstsq(normal, right, rcond=COLLINEAR)[0]
        values[kept] = found / norms
        return values, float(right @ found)


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

    @cached_property
    def _by_motor(self) -> tuple[np.ndarray, np.ndarray]:
        """The basis (n, M, f) and the remainder (n, M), motor by motor."""
        samples, n = self.moving.shape
        basis = self.basis.reshape(samples, n, -1).transpose(1, 0, 2)
        return np.ascontiguousarray(basis), np.ascontiguousarray(self.remainder.reshape(samples, n).T)

    def products(self, columns: np.ndarray) -> Products:
        """Inner products of columns (M, n, k), weighted, without what the basis explains of them."""
        basis, remainder = self._by_motor
        k = columns.shape[2]
        whole, within, towards = np.zeros((k, k)), np.zeros((basis.shape[2], k)), np.zeros(k)
        for j in np.flatnonzero(columns.any(axis=(0, 2))):
            rows = columns[:, j] * (self.moving[:, j] * self.weights[j])[:, None]
            whole += rows.T @ rows
            within += basis[j].T @ rows
            towards -= remainder[j] @ rows
        return Products(whole - within.T @ within, towards, np.sqrt(np.diag(whole)))

    def explained(self, columns: np.ndarray) -> tuple[np.ndarray, float]:
        """Least-squares coefficients (k,) of further columns, and the sum of squares that they explain."""
        return self.products(columns).explained()

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
