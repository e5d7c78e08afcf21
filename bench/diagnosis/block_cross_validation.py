"""Recordings cut into blocks, every other one fitted, to judge values that only one recording has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.identification.autocorrelation_time import autocorrelation_time
from bench.identification.compressed import Stack
from bench.identification.solution import Solution
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class BlockCrossValidation:
    """Normal equations of the linearised model: for either half of the blocks and every motor the inner products (2, n,
    S, S) of all columns, weighted, the error last. model_columns: how many are the model's; samples (n,): independent
    ones of each motor; measured (n,): weighted squares of the currents.
    """

    inner: np.ndarray
    model_columns: int
    samples: np.ndarray
    measured: np.ndarray

    def held_out_squares(self, columns: Sequence[int]) -> np.ndarray:
        """Residual squares (n,) on each half after a fit to the other one, with some of the further columns."""
        used = np.array([*range(self.model_columns), *(self.model_columns + i for i in columns)])
        squares = np.zeros(self.inner.shape[1])
        for fitted, held_out in ((0, 1), (1, 0)):
            values = _solution(self.inner[fitted].sum(axis=0), used)
            squares += np.einsum("i,nij,j->n", values, self.inner[held_out], values)
        return np.maximum(squares, np.finfo(float).tiny)

    def evidence(self, before: np.ndarray, after: np.ndarray) -> float:
        """Log-likelihood ratio, nats, of two models' residuals (n,), each motor with its noise."""
        return 0.5 * float(self.samples @ np.log(before / after))


def block_cross_validation(stack: Stack, solution: Solution, further: np.ndarray) -> BlockCrossValidation:
    """The equations about a model's solution, with further columns (M, n, k) of torque."""
    modelled = (stack.phi @ solution.theta + stack.kappa) / solution.gains * stack.moving
    error = stack.current - modelled
    count = np.maximum(stack.moving.sum(axis=0), 1)
    size = np.sqrt((error**2).sum(axis=0) / count)
    weights = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)  # zero for a motor without rows
    samples, n, p = stack.phi.shape
    fitted = np.broadcast_to(solution.gains_fitted, (n,))
    model_columns = p + (n if fitted.any() else 0)
    further = further * stack.moving[:, :, None]
    rows = np.zeros((n, samples, model_columns + further.shape[2] + 1))
    for j in range(n):
        rows[j, :, :p] = stack.phi[:, j] / solution.gains[j]
        if fitted[j]:
            rows[j, :, p + j] = -modelled[:, j] / solution.gains[j]
        rows[j, :, model_columns:-1] = further[:, j] / solution.gains[j]
        rows[j, :, -1] = error[:, j]
    rows *= weights[:, None, None]
    ends = [*stack.starts[1:], samples]
    half = np.concatenate(
        [
            (TOLERANCES.statistics.validated_blocks * np.arange(end - start) // (end - start)) % 2
            for start, end in zip(stack.starts, ends, strict=True)
        ]
    )
    inner = np.array([[row[half == k].T @ row[half == k] for row in rows] for k in (0, 1)])
    residuals = rows @ _solution(inner.sum(axis=(0, 1)), np.arange(rows.shape[2] - 1))
    parts = [np.split(entry[:, None], stack.starts[1:]) for entry in residuals]
    times = np.array([autocorrelation_time(part, stack.returns) for part in parts])
    measured = ((stack.current * weights) ** 2).sum(axis=0)
    return BlockCrossValidation(
        inner, model_columns, count / times, np.maximum(measured, np.finfo(float).tiny)
    )


def _solution(inner: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Coefficients (S,) of the columns in the remaining error: the used ones by least squares."""
    normal, right = inner[np.ix_(used, used)], inner[used, -1]
    lengths = np.sqrt(np.diag(normal))
    lengths[lengths == 0.0] = 1.0
    values = np.zeros(len(inner))
    scaled = normal / np.outer(lengths, lengths)
    values[used] = -np.linalg.lstsq(scaled, right / lengths, rcond=TOLERANCES.rank.products)[0] / lengths
    values[-1] = 1.0
    return values
