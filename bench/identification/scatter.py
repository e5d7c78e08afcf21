"""The scatter of an estimate between parts of the recordings: stretches of time, or states of a joint.

A model error depends on the state, so it repeats whenever a joint returns to the same position with the same velocity,
however much later. The scatter of estimates between clusters of rows includes such errors (Liang and Zeger,
"Longitudinal data analysis using generalized linear models", Biometrika 73, 1986).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import stdtrit

from bench.basics.chi_squared import WITHIN_95, exceeded_with
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES
from bench.signals.returning import Course


@dataclass(frozen=True)
class Block:
    """Part of a recording: normal equations J'J (P, P) and J'e (P,) of its rows."""

    normal: np.ndarray
    score: np.ndarray

    def __add__(self, other: "Block") -> "Block":
        return Block(self.normal + other.normal, self.score + other.score)


def block_of(jacobian: np.ndarray, error: np.ndarray) -> Block:
    """From derivatives (K, P) and errors (K,) of rows."""
    return Block(jacobian.T @ jacobian, jacobian.T @ error)


@dataclass(frozen=True)
class Scatter:
    """covariance (P, P) of an estimate from its scatter between blocks; freedom: its independent squares if errors are
    noise; blocks: number that inform on the same unknown.
    """

    covariance: np.ndarray
    freedom: float
    blocks: int

    @property
    def stated(self) -> np.ndarray:
        """The covariance, enlarged by Student's t for few blocks: 1.96 standard errors contain 95 %."""
        return np.asarray(self.covariance * (stdtrit(self.blocks - 1, 0.975) / WITHIN_95) ** 2)

    def beyond(self, noise: np.ndarray) -> bool:
        """Whether the scatter of all unknowns together exceeds that of noise of this covariance (P, P)."""
        values, vectors = np.linalg.eigh(noise)
        seen = values > TOLERANCES.rank.products * values[-1]
        turned = vectors[:, seen].T @ self.covariance @ vectors[:, seen]
        ratio = float((np.diag(turned) / values[seen]).mean())
        return ratio > exceeded_with(RULE.surprising, self.freedom) / self.freedom


def blocks_in(starts: tuple[int, ...], rows: int) -> Iterator[slice]:
    """The rows of every block, of all recordings."""
    for a, b in zip(starts, (*starts[1:], rows), strict=True):
        count = min(TOLERANCES.statistics.blocks, max((b - a) // TOLERANCES.statistics.block_rows, 1))
        edges = np.linspace(a, b, count + 1).astype(int)
        yield from (slice(int(x), int(y)) for x, y in pairwise(edges))


def state_cells(courses: Sequence[Course]) -> tuple[np.ndarray, np.ndarray]:
    """For every row of the recordings and every joint the number of its cell of position, and of velocity: (M, n) each.

    Quantiles bound the cells, so that each has as many rows.
    """
    position = np.concatenate([course.position for course in courses])
    velocity = np.concatenate([np.gradient(course.position, axis=0) for course in courses])
    return _cells(position), _cells(velocity)


def _cells(signals: np.ndarray) -> np.ndarray:
    """The cell (M, n) of each signal (M, n) in each row."""
    count = TOLERANCES.statistics.blocks
    edges = np.quantile(signals, np.arange(1, count) / count, axis=0)
    return np.column_stack(
        [np.searchsorted(edge, signal) for edge, signal in zip(edges.T, signals.T, strict=True)]
    )


def block_scatter(blocks: Sequence[Block], motors: int = 1) -> Scatter | None:
    """The scatter of the estimate between blocks, each of one of `motors` motors, or of all; None if they are too few.

    With J'J = sum of all blocks = (R R')^-1, a block b moves the estimate by R z_b, where z_b = (1 - R' J_b' J_b
    R)^(-1/2) R' J_b' e_b: the root compensates for the part of the block's error that the fit absorbs, so that the sum
    of squares is right on average if errors are noise (Bell and McCaffrey 2002).
    """
    if len(blocks) < motors * TOLERANCES.statistics.fewest_blocks:
        return None
    values, vectors = np.linalg.eigh(sum(block.normal for block in blocks))
    seen = values > TOLERANCES.rank.products * values[-1]
    root = vectors[:, seen] / np.sqrt(values[seen])
    moved, squares = [], 0.0
    for block in blocks:
        share, turned = np.linalg.eigh(root.T @ block.normal @ root)
        remaining = np.maximum(1.0 - share, TOLERANCES.rank.combination)
        moved.append(root @ turned @ ((turned.T @ root.T @ block.score) / np.sqrt(remaining)))
        squares += float((share**2).sum())
    shifts = np.array(moved)
    return Scatter(shifts.T @ shifts, int(seen.sum()) ** 2 / squares, len(blocks) // motors)
