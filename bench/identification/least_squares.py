"""Least squares and weighted least squares (equations 9 and 10)."""

import numpy as np

from bench.basics.errors import BenchError
from bench.identification.compressed import Stack
from bench.identification.solution import (
    NominalGains,
    Solution,
    scaled_lstsq,
    solved_gains,
    torque_residual_rms,
    torque_system,
    weighted,
)
from bench.identification.tolerances import TOLERANCES


def least_squares(stack: Stack, gains: NominalGains) -> Solution:
    """IDIM-LS, equation 10; with `gains.fitted`, gains are unknowns besides the parameters (equation 12).

    The currents' noise then is in the columns of the gains and draws them towards zero; TLS and the
    current-domain estimator do not have that bias.
    """
    return _solve(stack, gains, np.ones(len(gains.values)))


def weighted_least_squares(stack: Stack, gains: NominalGains) -> Solution:
    """IDIM-WLS (Gautier 1997): every motor's equation divided by the deviation of its error."""
    solution = least_squares(stack, gains)
    for _ in range(TOLERANCES.steps.reweightings):
        weights = row_weights(stack, solution)
        solution = _solve(stack, gains, weights)
    return solution


def row_weights(stack: Stack, solution: Solution) -> np.ndarray:
    """1 / RMS of every motor's torque error, (n,); a motor without error gets the largest weight."""
    rms = torque_residual_rms(stack, solution.theta, solution.gains)
    scale = (
        np.linalg.norm(stack.factors[:, :, -1], axis=1) * np.abs(solution.gains) / np.sqrt(len(stack.current))
    )
    return np.asarray(1.0 / np.maximum(rms, 1e-9 * scale.max() + np.finfo(float).tiny))


def _solve(stack: Stack, gains: NominalGains, weights: np.ndarray) -> Solution:
    rows, right = torque_system(weighted(stack.factors, weights), gains.held)
    x = scaled_lstsq(rows, right)
    p = stack.phi.shape[2]
    fitted_gains = solved_gains(stack.factors, gains.with_fitted(x[p:]), gains.values)
    return Solution(x[:p], fitted_gains, weights, "torque", gains.fitted)


def total_least_squares(stack: Stack) -> Solution:
    """IDIM-TLS: the compatible system closest to equation 13 in the Frobenius norm.

    The null vector is scaled so that delta, the factor of the known payload, is one.
    """
    rows = _homogeneous(stack.factors, np.ones(stack.current.shape[1]))
    vector = np.linalg.svd(rows, full_matrices=False)[2][-1]
    return _scaled(stack, vector, np.ones(stack.current.shape[1]))


def weighted_total_least_squares(stack: Stack, start: Solution, column_errors: np.ndarray) -> Solution:
    """Generalised TLS, with the sizes of the errors of rows and columns.

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
