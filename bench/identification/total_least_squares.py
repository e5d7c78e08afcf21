"""Total least squares for gains and parameters together (equations 12 and 13)."""

import numpy as np

from bench.basics.errors import BenchError
from bench.identification.compressed import Stack
from bench.identification.least_squares import row_weights
from bench.identification.solution import Solution, torque_system, weighted
from bench.identification.tolerances import TOLERANCES


def total_least_squares(stack: Stack) -> Solution:
    """IDIM-TLS: the compatible system closest to equation 13 in the Frobenius norm.

    The null vector is scaled so that delta, the factor of the known payload, is one.
    """
    rows = _homogeneous(stack.factors, np.ones(stack.current.shape[1]))
    vector = np.linalg.svd(rows, full_matrices=False)[2][-1]
    return _scaled(stack, vector, np.ones(stack.current.shape[1]))


def weighted_total_least_squares(stack: Stack, start: Solution, column_errors: np.ndarray) -> Solution:
    """TLS with the errors of rows and columns taken for what they are (generalised TLS).

    column_errors (n, p + 2, p + 2): for every motor the expected inner products of the errors of
    [phi, kappa, current]; see bench.identification.column_errors. Rows are divided by their motor's torque error,
    then the solution minimises |W x|^2 / x' C x with C the sum of the column errors (Van Huffel and
    Vandewalle 1991, chapter 10).
    """
    solution = start
    for _ in range(TOLERANCES.steps.total_reweightings):
        weights = row_weights(stack, solution)
        rows = _homogeneous(stack.factors, weights)
        lengths = np.linalg.norm(rows, axis=0)
        lengths[lengths == 0.0] = 1.0
        errors = sum(
            _spread(c * w * w, j, len(weights))
            for j, (c, w) in enumerate(zip(column_errors, weights, strict=True))
        )
        errors = errors / np.outer(lengths, lengths)
        root = np.linalg.cholesky(errors + TOLERANCES.rank.column_error**2 * np.eye(len(errors)))
        # rows / lengths = Q R; minimise |R x| over |root' x| = 1 with y = root' x
        triangle = np.asarray(np.linalg.qr(rows / lengths, mode="r"))
        whitened = np.linalg.solve(root, triangle.T).T
        y = np.linalg.svd(whitened, full_matrices=False)[2][-1]
        solution = _scaled(stack, np.linalg.solve(root.T, y) / lengths, weights)
    return solution


def _homogeneous(factors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Rows of W_tot in equation 13, columns [theta, g, delta]."""
    rows, right = torque_system(weighted(factors, weights), None)
    return np.column_stack((rows, -right))


def _spread(errors: np.ndarray, motor: int, motors: int) -> np.ndarray:
    """A motor's (p + 2, p + 2) error products in the order of equation 13's columns and with their signs."""
    p = len(errors) - 2
    take = np.zeros((p + 2, p + motors + 1))
    take[:p, :p] = -np.eye(p)
    take[p, -1] = -1.0
    take[p + 1, p + motor] = 1.0
    return np.asarray(take.T @ errors @ take)


def _scaled(stack: Stack, vector: np.ndarray, weights: np.ndarray) -> Solution:
    p = stack.phi.shape[2]
    if abs(vector[-1]) < 1e-12 * np.abs(vector).max():
        raise BenchError("total least squares: the known payload does not show in the currents; no scale")
    vector = vector / vector[-1]
    return Solution(vector[:p], vector[p:-1], weights, "torque", True)
