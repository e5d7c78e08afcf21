"""What more columns would explain, without solving the whole system again (Frisch, Waugh and Lovell)."""

from dataclasses import dataclass

import numpy as np

from bench.identification.compressed import Stack
from bench.identification.solution import Solution
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class RegressionProducts:
    """Products of columns after projection on the complement of others: inner products (k, k), those with the residual
    (k,), and the lengths (k,) of the whole columns.
    """

    inner: np.ndarray
    towards: np.ndarray
    lengths: np.ndarray

    @property
    def remaining(self) -> np.ndarray:
        """Share (k,) of every column's length that remains."""
        remaining = np.sqrt(np.maximum(np.diag(self.inner), 0.0))
        return np.divide(remaining, self.lengths, out=np.zeros_like(remaining), where=self.lengths > 0.0)

    def explained(self) -> tuple[np.ndarray, float]:
        """Least-squares coefficients (k,), and the sum of squares that they explain.

        A column without remainder explains nothing: its rounding error would, by chance.
        """
        values = np.zeros(len(self.towards))
        kept = np.flatnonzero(self.remaining > TOLERANCES.rank.remainder)
        if not len(kept):
            return values, 0.0
        norms = np.sqrt(np.diag(self.inner)[kept])
        normal = self.inner[np.ix_(kept, kept)] / np.outer(norms, norms)
        right = self.towards[kept] / norms
        coefficients = np.linalg.lstsq(normal, right, rcond=TOLERANCES.rank.products)[0]
        values[kept] = coefficients / norms
        return values, float(right @ coefficients)


@dataclass(frozen=True)
class PartialRegression:
    """The linearised system of the current errors, with its columns projected out of everything else.

    The unknowns are [theta, g], or theta alone where all gains are fixed. columns (n, M, f): weighted, motor by motor,
    zero where a joint does not move; basis (f, r): combines them so that they are orthonormal over all motors;
    remainder (M, n): minus the weighted error; weights (n,): one over each motor's error in torque; moving (M, n).
    """

    columns: np.ndarray
    basis: np.ndarray
    remainder: np.ndarray
    weights: np.ndarray
    moving: np.ndarray

    def products(self, columns: np.ndarray) -> RegressionProducts:
        """Inner products of further weighted columns (M, n, k), projected on the complement of the basis."""
        k = columns.shape[2]
        whole, across, towards = np.zeros((k, k)), np.zeros((len(self.basis), k)), np.zeros(k)
        for j in np.flatnonzero(np.einsum("mjk,mjk->j", columns, columns)):
            rows = columns[:, j] * (self.moving[:, j] * self.weights[j])[:, None]
            whole += rows.T @ rows
            across += self.columns[j].T @ rows
            towards -= self.remainder[:, j] @ rows
        within = self.basis.T @ across
        return RegressionProducts(whole - within.T @ within, towards, np.sqrt(np.diag(whole)))

    def explained(self, columns: np.ndarray) -> tuple[np.ndarray, float]:
        """Least-squares coefficients (k,) of further columns, and the sum of squares that they explain."""
        return self.products(columns).explained()

    @property
    def lacks(self) -> np.ndarray:
        """Torque (M, n) that the model lacks, N*m or N."""
        return np.asarray(-self.remainder / self.weights)

    @property
    def sum_of_squares(self) -> float:
        """What remains of the right side, weighted."""
        return float((self.remainder**2).sum())


def partial_regression(stack: Stack, solution: Solution) -> PartialRegression:
    """The regression for a solved system, linearised about its current-domain `solution`.

    The residual is current - (phi theta + kappa) / g. A further column of torque enters divided by -g; one that
    only scales everything, as a known payload does, is in the span of phi and the gains' columns.
    """
    samples, n, p = stack.phi.shape
    modelled = (stack.phi @ solution.theta + stack.kappa) / solution.gains
    error = (stack.current - modelled) * stack.moving
    rms = np.sqrt((error**2).sum(axis=0) / np.maximum(stack.moving.sum(axis=0), 1))
    inverse_rms = 1.0 / np.maximum(rms, 1e-12 * rms.max() + np.finfo(float).tiny)
    weights = inverse_rms / solution.gains
    fitted = np.broadcast_to(solution.gains_fitted, (n,))
    size = p + (n if fitted.any() else 0)
    columns, factors = np.zeros((n, samples, size)), np.zeros((n, stack.factors.shape[1], size))
    of_gain = np.append(solution.theta, [1.0, 0.0]) / solution.gains[:, None]
    for j in range(n):
        columns[j, :, :p] = stack.phi[:, j] * weights[j]
        factors[j, :, :p] = stack.factors[j, :, :p] * weights[j]
        if fitted[j]:
            columns[j, :, p + j] = -modelled[:, j] * weights[j]
            factors[j, :, p + j] = -(stack.factors[j] @ of_gain[j]) * weights[j]
    basis = _orthonormal(factors.reshape(-1, size))
    target = -(error * inverse_rms)
    for _ in range(2):  # the second time for the rounding errors of the first
        explained = basis @ (basis.T @ sum(column.T @ target[:, j] for j, column in enumerate(columns)))
        target = target - np.stack([column @ explained for column in columns], axis=1)
    return PartialRegression(columns, basis, target, weights, stack.moving)


def torque_errors(stack: Stack, solution: Solution) -> np.ndarray:
    """Torque (M, n) that a solved system lacks, N*m or N; zero where a joint does not move."""
    lacks = stack.current * solution.gains - stack.phi @ solution.theta - stack.kappa
    return np.asarray(lacks * stack.moving)


def _orthonormal(factor: np.ndarray) -> np.ndarray:
    """Matrix (f, r) that makes columns (R, f) orthonormal, of the same span."""
    norms = np.linalg.norm(factor, axis=0)
    norms[norms == 0.0] = 1.0
    _, singular, vectors = np.linalg.svd(factor / norms, full_matrices=False)
    kept = singular > 1e-10 * singular[0]
    return np.asarray(vectors[kept].T / singular[kept] / norms[:, None])
