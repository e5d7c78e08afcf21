"""Drive gains from which a better model can be reached, where a model that lacks much has run away."""

from dataclasses import replace

import numpy as np

from bench.identification.compressed import Stack
from bench.identification.decision import RULE
from bench.identification.solution import (
    Solution,
    scaled_lstsq,
    torque_residual_rms,
    torque_system,
    weighted,
)


def restarted(stack: Stack, solution: Solution, nominal: np.ndarray) -> Solution:
    """The solution, with nominal gains for those that are negative or far from them, and theta (p,) solved anew.

    Gains that are all off by about the same factor, in a model that explains at least `RULE.most` of the squared
    currents, have not run away: the nominal ones, or the currents, are in another unit. A model that lacks strong
    friction may fit best with gains without bounds, near zero, or below; steps of the current's error never lead back
    from there. nominal (n,): nominal drive gains. Columns that are zero or absorbed get the least values.
    """
    ratio = solution.gains / nominal
    away = (ratio < 1.0 / RULE.gain_lost) | (ratio > RULE.gain_lost)
    together = bool(np.all(ratio > 0.0)) and ratio.max() < RULE.gain_lost * ratio.min()
    if not (np.any(solution.gains_fitted) and away.any()):
        return solution
    if away.all() and together and _explained(stack, solution) >= RULE.most:
        return solution
    gains = np.where(away, nominal, solution.gains)
    rows, right = torque_system(weighted(stack.factors, solution.weights / gains), gains)
    return replace(solution, theta=scaled_lstsq(rows, right), gains=gains)


def _explained(stack: Stack, solution: Solution) -> float:
    """Share of the squared currents that a solution explains, the mean of all motors that move."""
    measured = np.mean(stack.current**2, axis=0)
    error = torque_residual_rms(stack, solution.theta, solution.gains) / solution.gains
    moving = measured > 0.0
    return float(1.0 - np.mean(error[moving] ** 2 / measured[moving])) if moving.any() else 0.0
