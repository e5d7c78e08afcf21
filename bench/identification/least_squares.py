"""Least squares and weighted least squares (equations 9 and 10)."""

import numpy as np

from bench.identification.compressed import Stack
from bench.identification.solution import Solution, scaled_lstsq, torque_residual_rms, torque_system, weighted

REWEIGHTINGS = 3


def least_squares(stack: Stack, nominal: np.ndarray, fit_gains: bool) -> Solution:
    """IDIM-LS, equation 10; with `fit_gains` the gains are unknowns of equation 12 beside the parameters.

    The currents' noise then stands in the columns of the gains and draws them towards zero; TLS and the
    current-domain estimator do not have that bias.
    """
    return _solve(stack, nominal, np.ones(len(nominal)), fit_gains)


def weighted_least_squares(stack: Stack, nominal: np.ndarray, fit_gains: bool) -> Solution:
    """IDIM-WLS (Gautier 1997): every motor's equation divided by the deviation of its error."""
    solution = least_squares(stack, nominal, fit_gains)
    for _ in range(REWEIGHTINGS):
        weights = row_weights(stack, solution)
        solution = _solve(stack, nominal, weights, fit_gains)
    return solution


def row_weights(stack: Stack, solution: Solution) -> np.ndarray:
    """1 / RMS of every motor's torque error, (n,); a motor without error counts as the best one with it."""
    rms = torque_residual_rms(stack, solution.theta, solution.gains)
    scale = (
        np.linalg.norm(stack.factors[:, :, -1], axis=1) * np.abs(solution.gains) / np.sqrt(len(stack.current))
    )
    return np.asarray(1.0 / np.maximum(rms, 1e-9 * scale.max() + np.finfo(float).tiny))


def _solve(stack: Stack, nominal: np.ndarray, weights: np.ndarray, fit_gains: bool) -> Solution:
    rows, right = torque_system(weighted(stack.factors, weights), None if fit_gains else nominal)
    x = scaled_lstsq(rows, right)
    p = stack.phi.shape[2]
    gains = x[p:] if fit_gains else nominal
    return Solution(x[:p], gains, weights, "torque", fit_gains)
