"""Estimator for currents with bad intervals: their errors follow Student's distribution, not Gauss's.

A row far from the model then has a small weight, (nu + 1) / (nu + r^2), r its error over the scale of its motor. Scale
and degrees of freedom nu of every motor are estimated with the parameters by maximum likelihood, so that clean data are
fitted as by least squares (nu grows) at little loss. Iteratively reweighted least squares: Lange, Little and Taylor,
"Robust statistical modeling using the t distribution", 1989; nu as by Liu and Rubin, "ML estimation of the t
distribution using EM and its extensions, ECM and ECME", 1995.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import lgamma, log, pi

import numpy as np

from bench.identification.bounded import minimum_between
from bench.identification.compressed import Stack, compress
from bench.identification.current_error import current_error, current_floor, minimum_on_factors
from bench.identification.finding import Code, Finding
from bench.identification.observation import Observation
from bench.identification.solution import Fitted, Solution, scaled_lstsq, torque_system
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class _Fit:
    """A maximum of the likelihood: parameters, scale (n,), degrees of freedom (n,), weights (M, n) of the rows."""

    theta: np.ndarray
    gains: np.ndarray
    scale: np.ndarray
    freedom: np.ndarray
    weights: np.ndarray
    error: np.ndarray
    minus_likelihood: float


def robust_error(stack: Stack, start: Solution, nominal: np.ndarray) -> Solution:
    """Maximum likelihood of currents v_j = (Phi_j theta + kappa_j) / g_j + s_j t, t of Student's distribution.

    Searched from the least-squares answer, `start`, and from nominal gains (n,), since bad intervals can distort the
    former; the likelier answer is taken. Gains that are not unknowns (start.gains_fitted) are held. Nonlinear effects
    keep the shape of least squares.
    """
    solution = current_error(stack, start)
    theta, gains = solution.theta, solution.gains
    if np.any(start.gains_fitted):
        fixed = _likeliest(
            stack, scaled_theta(stack, nominal), nominal, False, TOLERANCES.robust.start_rounds
        )
        starts = ((theta, gains), (fixed.theta, nominal))
        tried = [
            _likeliest(stack, *pair, start.gains_fitted, TOLERANCES.robust.start_rounds) for pair in starts
        ]
        best = min(tried, key=lambda fit: fit.minus_likelihood)
        theta, gains = best.theta, best.gains
    likeliest = _likeliest(stack, theta, gains, start.gains_fitted)
    moving = stack.moving
    squares, nu = (likeliest.error / likeliest.scale) ** 2, likeliest.freedom
    slopes = ((nu + 1.0) * (nu - squares) / (nu + squares) ** 2 * moving).sum(axis=0)  # of weight times error
    dispersion = likeliest.weights.sum(axis=0) / np.maximum(slopes, np.finfo(float).tiny)
    root = np.sqrt(
        np.divide(likeliest.weights, dispersion, out=np.zeros_like(likeliest.weights), where=dispersion > 0.0)
    )
    return replace(
        solution,
        theta=likeliest.theta,
        gains=likeliest.gains,
        weights=1.0 / likeliest.scale,
        transform=lambda given: weighted_rows(given, root),
        dispersion=dispersion,
        row_weights=likeliest.weights * likeliest.freedom / (likeliest.freedom + 1.0),
    )


def _likeliest(
    stack: Stack, theta: np.ndarray, gains: np.ndarray, fit_gains: Fitted, most: int | None = None
) -> _Fit:
    """The nearest maximum of the likelihood, after at most `most` rounds, by default all."""
    moving, floor = stack.moving, current_floor(stack)
    error = _error(stack, theta, gains)
    scale = np.maximum(_typical(error, moving), floor)
    freedom = np.full(len(gains), TOLERANCES.robust.first_freedom)
    weights = _weights(error / scale, freedom) * moving
    for _ in range(TOLERANCES.robust.rounds if most is None else most):
        factors = weighted_rows(stack, np.sqrt(weights)).factors
        theta, gains = minimum_on_factors(
            factors, theta, gains, 1.0 / scale, fit_gains, TOLERANCES.steps.between_weights
        )
        error = _error(stack, theta, gains)
        squares = (weights * error**2).sum(axis=0) / np.maximum(moving.sum(axis=0), 1)
        scale = np.maximum(np.sqrt(squares), floor)
        each = [degrees_of_freedom(error[moving[:, j], j] / scale[j]) for j in range(len(gains))]
        freedom = np.array([nu for nu, _ in each])
        before, weights = weights, _weights(error / scale, freedom) * moving
        if np.abs(weights - before).max() < TOLERANCES.robust.settled:
            break
    logarithms = np.array([value for _, value in each]) + np.log(scale)
    return _Fit(theta, gains, scale, freedom, weights, error, float(moving.sum(axis=0) @ logarithms))


def scaled_theta(stack: Stack, gains: np.ndarray) -> np.ndarray:
    """Least-squares parameters (p,) with these drive gains."""
    return scaled_lstsq(*torque_system(stack.factors, gains))


def weighted_rows(stack: Stack, root: np.ndarray) -> Stack:
    """The equations with every motor's rows multiplied by factors `root` (M, n)."""
    phi, kappa, current = stack.phi * root[:, :, None], stack.kappa * root, stack.current * root
    return replace(stack, phi=phi, kappa=kappa, current=current, factors=compress(phi, kappa, current))


def degrees_of_freedom(error: np.ndarray) -> tuple[float, float]:
    """Student's nu of errors (M,) over their scale by maximum likelihood, and minus its mean log-likelihood."""
    squares = error**2

    def minus_likelihood(logarithm: float) -> float:
        nu = float(np.exp(logarithm))
        each = lgamma(0.5 * (nu + 1.0)) - lgamma(0.5 * nu) - 0.5 * log(nu * pi)
        return float(0.5 * (nu + 1.0) * np.log1p(squares / nu).sum()) / max(len(squares), 1) - each

    bounds = TOLERANCES.robust
    logarithm, value = minimum_between(
        minus_likelihood, log(bounds.least_freedom), log(bounds.most_freedom), 1e-4
    )
    return float(np.exp(logarithm)), value


def _error(stack: Stack, theta: np.ndarray, gains: np.ndarray) -> np.ndarray:
    return np.asarray(stack.current - (stack.phi @ theta + stack.kappa) / gains)


def _typical(error: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Scale (n,) that bad rows do not affect: the median absolute error, as a standard deviation of noise."""
    return np.array(
        [
            1.4826 * np.median(np.abs(entry[seen])) if seen.any() else 0.0
            for entry, seen in zip(error.T, moving.T, strict=True)
        ]
    )


def _weights(error: np.ndarray, freedom: np.ndarray) -> np.ndarray:
    """Weights (M, n) of errors over their scale."""
    return np.asarray((freedom + 1.0) / (freedom + error**2))


def bad_stretches(
    observations: Sequence[Observation], row_weights: np.ndarray, joints: Sequence[str]
) -> list[Finding]:
    """A finding for each stretch of a recording in which a motor's current has little weight, in log order.

    row_weights (M, n): of every row of all recordings, 1 where it fits. Rows of a joint at standstill are no finding.
    """
    bounds = TOLERANCES.findings
    findings: list[tuple[int, Finding]] = []
    start = 0
    for observation in observations:
        of_recording = row_weights[start : start + len(observation.time)]
        start += len(observation.time)
        for j, joint in enumerate(joints):
            little = np.flatnonzero((of_recording[:, j] < bounds.bad_weight) & observation.moving[:, j])
            for part in np.split(little, np.flatnonzero(np.diff(little) > bounds.bridged_rows) + 1):
                if len(part) >= bounds.bad_rows:
                    numbers = {
                        "start": float(observation.time[part[0]]),
                        "end": float(observation.time[part[-1]]),
                    }
                    findings.append(
                        (len(part), Finding(Code.BAD_STRETCH, (joint, observation.name), numbers=numbers))
                    )
    longest = sorted(range(len(findings)), key=lambda i: -findings[i][0])[: TOLERANCES.report.stretches]
    return [findings[i][1] for i in sorted(longest)]
