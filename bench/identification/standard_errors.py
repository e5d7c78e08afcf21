"""Covariance of an estimate with correlated errors.

Model errors return with the motion. Their autocovariance says little about their influence on an estimate, since they
correlate as long as the motion does. The scatter of the estimate between parts of the recordings is valid for any kind
of error.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.special import stdtrit

from bench.basics.chi_squared import WITHIN_95
from bench.identification.autocorrelation_time import (
    Returns,
    repeated_covariances,
    repeated_score,
    times_repeated,
)
from bench.identification.compressed import Stack
from bench.identification.decision import RULE
from bench.identification.scatter import Block, Scatter, block_of, block_scatter, blocks_in, state_cells
from bench.identification.solution import Solution
from bench.identification.tolerances import TOLERANCES
from bench.signals.returning import lagged_products

Deviations = Literal["autocorrelated", "serial", "independent"]
StdFrom = Literal["noise", "blocks", "periods", "models", "instruments", "payload", "bandwidth"]
"""Source of standard errors: the error as noise, the scatter of the estimate between parts of the recordings, the error
as one that returns with the motion, the spread over models that explain the data as well, the distance from
instrumental variables, from a physically possible payload, or from the estimate in another band.
"""


@dataclass(frozen=True)
class Uncertainty:
    """covariance (p + n, p + n) of [theta, g] (gains zero where fixed); rank and condition of the system of so
    many unknowns.

    condition: of the weighted Jacobian with unscaled columns; scaled_condition: with columns of unit length. std_from:
    the error as noise, or the scatter between parts of the recordings.
    """

    covariance: np.ndarray
    rank: int
    unknowns: int
    condition: float
    scaled_condition: float
    std_from: StdFrom = "noise"


def residual_series(stack: Stack, solution: Solution) -> np.ndarray:
    """The error (M, n) that the estimator minimised, in torque or current units."""
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
    if not np.any(solution.gains_fitted):
        return rigid
    full = np.zeros((*rigid.shape[:2], rigid.shape[2] + n))
    full[:, :, : rigid.shape[2]] = rigid
    full[:, np.arange(n), rigid.shape[2] + np.arange(n)] = by_gain * solution.gains_fitted
    return full


def uncertainty(stack: Stack, solution: Solution, deviations: Deviations) -> Uncertainty:
    """Standard deviations of the estimate from its residual.

    "autocorrelated": the residual's autocovariance, of every motor and within every recording, is propagated through
    the linearised estimator (Newey and West 1987, with Bartlett's window), so that neighbouring samples do not count as
    independent, nor do samples a period apart if errors return with the motion (see `repeated_covariances`).
    "independent": the field's customary formula (Gautier 1997), with the deviation of the residual about its mean; too
    optimistic for coloured errors. Unknowns without influence, such as the damping of a drive without a compliance, are
    omitted, with variances of zero.

    If the estimate scatters more between parts of the recordings than autocorrelated noise explains, the model is
    wrong, and the deviations are those of the scatter wherever these are larger. Every scatter (between stretches of
    time, positions, velocities) is compared with noise alone: an error that depends on the position would otherwise
    count only if it exceeded one that changes with time. "serial": parts in time only, not in positions or velocities.
    """
    if solution.transform is not None:
        stack = solution.transform(stack)
    residual = residual_series(stack, solution) * solution.weights
    if solution.dispersion is not None:
        residual = residual * solution.dispersion
    if solution.instruments is not None:
        stack = solution.instruments(stack)
    triangle = np.concatenate(
        [
            weight * by_unknowns(factor, solution, j)
            for j, (factor, weight) in enumerate(zip(stack.factors, solution.weights, strict=True))
        ]
    )
    lengths = np.linalg.norm(triangle, axis=0)
    seen = np.flatnonzero(lengths)
    size, lengths = len(seen), lengths[seen]
    unit = triangle[:, seen] / lengths
    singular = np.linalg.svd(np.linalg.qr(unit, mode="r"), compute_uv=False)
    rank = int((singular > 1e-10 * singular[0]).sum())
    inverse = np.linalg.pinv(unit.T @ unit, rcond=1e-18, hermitian=True)
    std_from: StdFrom = "noise"
    if deviations == "independent":
        middle = inverse * float(residual[stack.moving].var(ddof=1))
    else:
        parts = np.split(residual, stack.starts[1:])
        returns = stack.returns
        repeated = times_repeated(parts, returns, reach=0)
        std_from = "periods" if repeated > TOLERANCES.findings.repeated_rows else "noise"
        middle = inverse @ _score(stack, solution, residual, returns, seen, lengths) @ inverse
        middle *= _small_sample(float((middle * (unit.T @ unit)).sum()), float((residual**2).sum()), size)
        with_states = bool(stack.courses) and deviations != "serial"
        noise = middle
        for scatter in _scatters(stack, solution, residual, seen, lengths, with_states=with_states):
            if scatter is not None and scatter.beyond(noise):
                middle, std_from = _enlarged(middle, scatter.stated), "blocks"
    covariance = np.zeros((stack.phi.shape[2] + len(solution.gains),) * 2)
    covariance[np.ix_(seen, seen)] = middle / np.outer(lengths, lengths)
    raw = np.linalg.svd(np.linalg.qr(triangle[:, seen], mode="r"), compute_uv=False)
    return Uncertainty(
        covariance,
        rank,
        size,
        float(raw[0] / max(raw[-1], np.finfo(float).tiny)),
        float(singular[0] / max(singular[-1], np.finfo(float).tiny)),
        std_from,
    )


def _small_sample(taken: float, remaining: float, size: int) -> float:
    """Factor by which a covariance from the residual of a fit of `size` unknowns is too small.

    taken, remaining: squares of the error that the fit absorbs, tr(H Sigma) by the covariance to correct, and that
    remain. Correlated errors count as size * remaining / taken independent ones; the factor is for this number, so that
    1.96 standard errors contain 95 % by Student's t.
    """
    if not taken:
        return 1.0
    freedom = max(size * (remaining / taken - 1.0), 1.0)
    return float((1.0 + size / freedom) * (stdtrit(freedom, 0.975) / WITHIN_95) ** 2)


def _enlarged(covariance: np.ndarray, other: np.ndarray) -> np.ndarray:
    """A covariance (P, P) with its correlations and the deviations of another where these are larger."""
    stds, larger = (np.sqrt(np.maximum(np.diag(values), 0.0)) for values in (covariance, other))
    times = np.maximum(larger / np.where(stds > 0.0, stds, np.inf), 1.0)
    return covariance * np.outer(times, times)


def by_unknowns(rows: np.ndarray, solution: Solution, motor: int) -> np.ndarray:
    """A motor's rows (K, p + 2) of [phi, kappa, current] as derivatives (K, P) of its modelled side."""
    p, gain = len(solution.theta), solution.gains[motor]
    columns = np.zeros((len(rows), p + (len(solution.gains) if np.any(solution.gains_fitted) else 0)))
    columns[:, :p] = rows[:, :p] if solution.domain == "torque" else rows[:, :p] / gain
    if not np.broadcast_to(solution.gains_fitted, solution.gains.shape)[motor]:
        return columns
    if solution.domain == "torque":
        columns[:, p + motor] = -rows[:, p + 1]
    else:
        columns[:, p + motor] = -(rows[:, :p] @ solution.theta + rows[:, p]) / gain**2
    return columns


def _weighted_rows(
    stack: Stack, solution: Solution, motor: int, rows: slice, seen: np.ndarray, lengths: np.ndarray
) -> np.ndarray:
    """The derivatives of a motor's weighted rows by the unknowns seen, each divided by its length."""
    part = (stack.phi[rows, motor], stack.kappa[rows, motor], stack.current[rows, motor])
    derivatives = by_unknowns(np.column_stack(part), solution, motor)
    return np.asarray(solution.weights[motor] * derivatives[:, seen] / lengths)


def _scatters(
    stack: Stack,
    solution: Solution,
    residual: np.ndarray,
    seen: np.ndarray,
    lengths: np.ndarray,
    *,
    with_states: bool,
) -> list[Scatter | None]:
    """Scatter of the estimate between stretches of time and, on request, between positions and between velocities of a
    motor's joint; for the unknowns seen, each divided by its length.
    """
    stretches = list(blocks_in(stack.starts, len(residual)))
    in_time = [Block(np.zeros((len(seen),) * 2), np.zeros(len(seen))) for _ in stretches]
    kinds = state_cells(stack.courses) if with_states else ()
    by_state: list[list[Block]] = [[] for _ in kinds]
    motors = np.flatnonzero(stack.moving.any(axis=0))
    for j in motors.tolist():
        jacobian, error = _weighted_rows(stack, solution, j, slice(None), seen, lengths), residual[:, j]
        in_time = [
            block + block_of(jacobian[rows], error[rows])
            for block, rows in zip(in_time, stretches, strict=True)
        ]
        moving = stack.moving[:, j]
        for cells, blocks in zip(kinds, by_state, strict=True):
            rows_of = [moving & (cells[:, j] == cell) for cell in np.unique(cells[moving, j])]
            blocks += [block_of(jacobian[rows], error[rows]) for rows in rows_of]
    return [block_scatter(in_time), *(block_scatter(blocks, len(motors)) for blocks in by_state)]


def _score(
    stack: Stack,
    solution: Solution,
    residual: np.ndarray,
    returns: Returns,
    seen: np.ndarray,
    lengths: np.ndarray,
) -> np.ndarray:
    """J' Sigma J (P, P) of the weighted derivatives by the unknowns seen, each divided by its length."""
    ends = (*stack.starts[1:], len(residual))
    total = np.zeros((len(seen),) * 2)
    for j in range(len(solution.weights)):
        error, moving = residual[:, j], stack.moving[:, j]
        covariances = _covariances(error, moving, stack.starts)
        repeated = repeated_covariances(error, moving, stack.starts, returns, covariances)
        for a, b, period in zip(stack.starts, ends, returns, strict=True):
            jacobian = _weighted_rows(stack, solution, j, slice(a, b), seen, lengths)
            columns = np.flatnonzero(jacobian.any(axis=0))  # not the other motors' gains
            if not len(columns):
                continue
            total[np.ix_(columns, columns)] += _autocorrelated(jacobian[:, columns], covariances)
            if period is not None and repeated is not None:
                total[np.ix_(columns, columns)] += repeated_score(jacobian[:, columns], period, repeated)
    return total


def _covariances(residual: np.ndarray, moving: np.ndarray, starts: tuple[int, ...]) -> np.ndarray:
    """Tapered autocovariances (L + 1,) of one motor's residual (M,), zero where not moving, over all recordings.

    Lags beyond those of the low-pass count while errors still correlate: a longer window would include the lack of
    error at the few frequencies of the motion, which the fit absorbs.
    """
    ends = (*starts[1:], len(residual))
    shortest = min(b - a for a, b in zip(starts, ends, strict=True))
    most = min(int(np.ceil(1.5 * len(residual) ** (1 / 3))), TOLERANCES.statistics.most_lags, shortest - 1)
    signals = np.column_stack((residual, moving))
    products = sum(lagged_products(signals[a:b])[: most + 1] for a, b in zip(starts, ends, strict=True))
    pairs, counts = np.asarray(products).T
    counts = np.maximum(counts, 1.0)
    values = pairs / counts
    alike = np.abs(values) > RULE.shows * values[0] / np.sqrt(counts)
    lags = min(TOLERANCES.statistics.low_pass_lags, most)
    while lags < most and alike[lags + 1 : lags + 4].any():
        lags += 1
    return values[: lags + 1] * (1.0 - np.arange(lags + 1) / (lags + 1.0))


def _autocorrelated(jacobian: np.ndarray, covariances: np.ndarray) -> np.ndarray:
    """J' Sigma J (P, P) for derivatives J (M, P) and a stationary residual with these autocovariances.

    Sigma J is formed by blocks of rows: the same band of Sigma times rows in reach.
    """
    samples, size = jacobian.shape
    lags = len(covariances) - 1
    block = max(2 * lags, 32)
    count = -(-samples // block)
    reached = np.zeros((count * block + 2 * lags, size))
    reached[lags : lags + samples] = jacobian
    apart = np.abs(np.arange(block + 2 * lags) - lags - np.arange(block)[:, None])
    band = np.append(covariances, 0.0)[np.minimum(apart, lags + 1)]
    windows = sliding_window_view(reached, block + 2 * lags, axis=0)[::block].swapaxes(1, 2)
    spread = (band @ windows).reshape(-1, size)[:samples]
    total = jacobian.T @ spread
    return np.asarray(0.5 * (total + total.T))
