"""Instrumental variables: noise in the observation matrix no longer biases the estimate.

IDIM-IV (Janot, Vandanjon and Gautier, "A generic instrumental variable approach for industrial robot identification",
2014): W x = y is solved as Z' W x = Z' y, with an observation matrix Z of the simulated model, which contains the
motion but not the noise of the measurements. A controlled robot follows its reference whatever its parameters; so the
simulation is a twin that follows the measured motion with all its harmonics and no more.
"""

from dataclasses import replace

import numpy as np

from bench.identification.compressed import Stack, compress
from bench.identification.least_squares import row_weights
from bench.identification.solution import (
    NominalGains,
    Solution,
    scaled_lstsq,
    solved_gains,
    torque_system,
    weighted,
)
from bench.identification.tolerances import TOLERANCES


def instrumental_variables(
    stack: Stack, start: Solution, nominal: np.ndarray, simulated: np.ndarray
) -> Solution:
    """Gains and parameters by two-stage least squares: the columns of equation 12, projected on the instruments.

    simulated (M, n, p + 1): [Phi, kappa] at the motion of the twin, row by row as in the stack. Its columns are each
    motor's instruments, and so are their combinations, the simulated currents. start: for the first weights; its
    nominal gains (n,) stay.
    """
    bases = [_orthonormal(simulated[:, j] * stack.moving[:, j, None]) for j in range(len(nominal))]
    hat = projected(stack, bases)
    solution, known = start, NominalGains(nominal, start.gains_fitted)
    for _ in range(TOLERANCES.steps.reweightings):
        weights = row_weights(stack, solution)
        rows, right = torque_system(weighted(hat.factors, weights), known.held)
        x = scaled_lstsq(rows, right)
        p = stack.phi.shape[2]
        gains = solved_gains(stack.factors, known.with_fitted(x[p:]), nominal)
        solution = Solution(x[:p], gains, weights, "torque", start.gains_fitted)
    return replace(solution, instruments=lambda given: projected(given, bases))


def projected(stack: Stack, bases: list[np.ndarray]) -> Stack:
    """The equations with their columns of unknowns projected on the instruments; further columns unchanged.

    bases: for every motor j, orthonormal columns (M, r_j).
    """
    phi, current = stack.phi.copy(), stack.current.copy()
    for j, basis in enumerate(bases):
        phi[:, j] = basis @ (basis.T @ phi[:, j])
        current[:, j] = basis @ (basis.T @ current[:, j])
    return replace(stack, phi=phi, current=current, factors=compress(phi, stack.kappa, current))


def _orthonormal(columns: np.ndarray) -> np.ndarray:
    """An orthonormal basis (M, r) of the span of columns (M, k)."""
    norms = np.linalg.norm(columns, axis=0)
    seen = columns[:, norms > 0.0] / norms[norms > 0.0]
    vectors, singular, _ = np.linalg.svd(seen, full_matrices=False)
    return np.asarray(vectors[:, singular > TOLERANCES.rank.instruments * singular.max(initial=0.0)])
