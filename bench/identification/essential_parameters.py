"""Essential parameters: those without which the model would fit worse."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bench.identification.compressed import Stack, triangular_factors
from bench.identification.decision import RULE
from bench.identification.solution import Solution
from bench.identification.standard_errors import Deviations, Uncertainty, uncertainty
from bench.identification.tolerances import TOLERANCES

Solve = Callable[[Stack, np.ndarray], Solution]


def reduced(stack: Stack, kept: np.ndarray) -> Stack:
    """The equations with some columns of phi only, kept (k,) indices."""
    p = stack.phi.shape[2]
    factors = triangular_factors(stack.factors[:, :, [*kept, p, p + 1]].swapaxes(0, 1))
    return replace(stack, phi=stack.phi[:, :, kept], factors=factors)


def essential_columns(stack: Stack, candidates: int, solve: Solve, deviations: Deviations) -> np.ndarray:
    """Indices of the columns to keep: candidates (the first so many) are omitted one by one.

    The one with the largest relative deviation goes first, as long as that deviation is above 30 % and the
    error of the currents grows by less than 1 % in all (Gautier and Khalil; Khalil and Dombre 2002, 12.3).
    """
    kept = np.arange(stack.phi.shape[2])
    solution = solve(stack, kept)
    reference = _current_error(stack, solution)
    current = stack
    while True:
        spread = uncertainty(current, solution, deviations)
        std = np.sqrt(np.maximum(np.diag(spread.covariance)[: len(kept)], 0.0))
        size = np.abs(solution.theta)
        relative = np.where(kept < candidates, std / np.maximum(size, np.finfo(float).tiny), 0.0)
        worst = int(np.argmax(relative))
        if relative[worst] <= RULE.loose:
            return kept
        fewer = np.delete(kept, worst)
        smaller = reduced(stack, fewer)
        candidate = solve(smaller, fewer)
        if _current_error(smaller, candidate) > TOLERANCES.findings.omitted_growth * reference:
            return kept
        kept, current, solution = fewer, smaller, candidate


def expanded(
    solution: Solution, spread: Uncertainty, kept: np.ndarray, size: int
) -> tuple[Solution, Uncertainty]:
    """The solution with zeros for the parameters that were omitted.

    The covariance, of [kept parameters, shape parameters, gains], is put in the order [all parameters, gains,
    shape parameters].
    """
    theta = with_zeros(solution.theta, kept, size)
    n, k = len(solution.gains), len(kept)
    shapes = len(spread.covariance) - k - n
    index = np.concatenate((kept, size + n + np.arange(shapes), size + np.arange(n)))
    covariance = np.zeros((size + n + shapes,) * 2)
    covariance[np.ix_(index, index)] = spread.covariance
    return replace(solution, theta=theta), replace(spread, covariance=covariance)


def with_zeros(values: np.ndarray, kept: np.ndarray, size: int) -> np.ndarray:
    """Values (k,) at the indices kept (k,) of an array (size,) of zeros."""
    every = np.zeros(size)
    every[kept] = values
    return every


def _current_error(stack: Stack, solution: Solution) -> float:
    modelled = (stack.phi @ solution.theta + stack.kappa) / solution.gains
    return float(np.sqrt(((stack.current - modelled) ** 2).mean()))
