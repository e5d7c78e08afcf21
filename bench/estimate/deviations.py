"""Covariance of an estimate, with errors that are alike from one sample to the next."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.estimate.solution import Solution
from bench.estimate.stack import Stack

FEWEST_LAGS = 6  # of the autocovariance; what the low-pass of the fit makes of white noise dies out sooner
ALIKE = 3.0  # deviations of a correlation that is none

Deviations = Literal["autocorrelated", "independent"]


@dataclass(frozen=True)
class Uncertainty:
    """covariance (p + n, p + n) of [theta, g] (gains zero where fixed); rank and condition of the system of so
    many unknowns.

    condition: of the weighted Jacobian, columns as they are; scaled_condition: with columns of unit length.
    """

    covariance: np.ndarray
    rank: int
    unknowns: int
    condition: float
    scaled_condition: float


def residual_series(stack: Stack, solution: Solution) -> np.ndarray:
    """The error (M, n) that the estimator made small, in torque or current units."""
    modelled = stack.phi @ solution.theta + stack.kappa
    if solution.domain == "torque":
        return np.asarray(stack.current * solution.gains - modelled)
    return np.asarray(stack.current - modelled / solution.gains)


def jacobian_series(stack: Stack, solution: Solution) -> np.ndarray:
    """Derivative (M, n, P) of the modelled side by [theta] or [theta, g], in the residual's unit."""
    n = len(solution.gains)
    if solution.domain == "torque":
        rigid, by_gain = stack.phi, -stack.current
    else:
        rigid = stack.phi / solution.gains[:, None]
        by_gain = -(stack.phi @ solution.theta + stack.kappa) / solution.gains**2
    if not solution.gains_fitted:
        return rigid
    full = np.zeros((*rigid.shape[:2], rigid.shape[2] + n))
    full[:, :, : rigid.shape[2]] = rigid
    full[:, np.arange(n), rigid.shape[2] + np.arange(n)] = by_gain
    return full


def uncertainty(stack: Stack, solution: Solution, deviations: Deviations) -> Uncertainty:
    """Standard deviations of the estimate from its residual.

    "autocorrelated": the residual's autocovariance, of every motor and within every recording, is carried
    through the linearised estimator (Newey and West 1987, with Bartlett's window), so that neighbouring
    samples do not count as independent. "independent": the field's customary formula (Gautier 1997), with
    the deviation of the residual about its mean; too optimistic where errors are coloured. Unknowns that change
    nothing, such as the damping of a drive without a compliance, are left out, with variances of zero.
    """
    jacobian = jacobian_series(stack, solution) * solution.weights[:, None]
    residual = residual_series(stack, solution) * solution.weights
    samples, n, every = jacobian.shape
    lengths = np.linalg.norm(jacobian.reshape(-1, every), axis=0)
    seen = np.flatnonzero(lengths)
    size, lengths = len(seen), lengths[seen]
    jacobian = jacobian[:, :, seen] / lengths
    singular = np.linalg.svd(np.linalg.qr(jacobian.reshape(-1, size), mode="r"), compute_uv=False)
    rank = int((singular > 1e-10 * singular[0]).sum())
    inverse = np.linalg.pinv(np.einsum("kjp,kjq->pq", jacobian, jacobian), rcond=1e-18, hermitian=True)
    if deviations == "independent":
        middle = inverse * float(residual[stack.moving].var(ddof=1))
    else:
        score = sum(
            _autocorrelated(
                jacobian[a:b, j],
                residual[a:b, j],
                _covariances(residual[:, j], stack.moving[:, j], stack.starts),
            )
            for j in range(n)
            for a, b in zip(stack.starts, (*stack.starts[1:], samples), strict=True)
        )
        equations = int(stack.moving.sum())
        freedom = equations / max(equations - size, 1)
        middle = inverse @ score @ inverse * freedom
    covariance = np.zeros((stack.phi.shape[2] + n,) * 2)
    covariance[np.ix_(seen, seen)] = middle / np.outer(lengths, lengths)
    raw = np.linalg.svd(np.linalg.qr((jacobian * lengths).reshape(-1, size), mode="r"), compute_uv=False)
    return Uncertainty(
        covariance,
        rank,
        size,
        float(raw[0] / max(raw[-1], np.finfo(float).tiny)),
        float(singular[0] / max(singular[-1], np.finfo(float).tiny)),
    )


def _covariances(residual: np.ndarray, moving: np.ndarray, starts: tuple[int, ...]) -> np.ndarray:
    """Tapered autocovariances (L + 1,) of one motor's residual (M,), zero where not moving, over all recordings.

    Lags beyond FEWEST_LAGS are taken as long as the errors are still alike there: a longer window than needed
    would see the lack of error at the few frequencies of the movement, which the fit takes up.
    """
    ends = (*starts[1:], len(residual))
    shortest = min(b - a for a, b in zip(starts, ends, strict=True))
    most = min(int(np.ceil(1.5 * len(residual) ** (1 / 3))), shortest - 1)
    values, counts = np.zeros(most + 1), np.ones(most + 1)
    for lag in range(most + 1):
        pairs = count = 0.0
        for a, b in zip(starts, ends, strict=True):
            pairs += float(residual[a : b - lag] @ residual[a + lag : b])
            count += float(moving[a : b - lag] @ moving[a + lag : b].astype(float))
        values[lag], counts[lag] = pairs / max(count, 1.0), max(count, 1.0)
    alike = np.abs(values) > ALIKE * values[0] / np.sqrt(counts)
    lags = min(FEWEST_LAGS, most)
    while lags < most and alike[lags + 1 : lags + 4].any():
        lags += 1
    return values[: lags + 1] * (1.0 - np.arange(lags + 1) / (lags + 1.0))


def _autocorrelated(jacobian: np.ndarray, residual: np.ndarray, covariances: np.ndarray) -> np.ndarray:
    """J' Sigma J for a stationary residual with these autocovariances, (P, P)."""
    total = covariances[0] * (jacobian.T @ jacobian)
    for lag in range(1, min(len(covariances), len(residual))):
        product = jacobian[:-lag].T @ jacobian[lag:]
        total += covariances[lag] * (product + product.T)
    return np.asarray(total)
