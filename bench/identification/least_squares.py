"""Least squares and weighted least squares (equations 9 and 10)."""

import numpy as np

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
    """IDIM-LS, equation 10; with `gains.fitted` they are unknowns of equation 12 in addition to the parameters.

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
    """1 / RMS of every motor's torque error, (n,); a motor without error counts as the best one with it."""
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
