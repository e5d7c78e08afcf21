"""How an estimate scatters from one part of the recordings to the next: deviations where the error is not noise.

What a model lacks makes errors that return with the motion. Their autocovariance says little of what they do to an
estimate, since they are alike for as long as the motion is. What each part of the recordings does to it by itself
holds whatever they are.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import stdtrit

from bench.basics.chi_squared import WITHIN_95, exceeded_with
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Block:
    """What one part of a recording says: normal equations J'J (P, P) and J'e (P,) of its rows."""

    normal: np.ndarray
    score: np.ndarray


@dataclass(frozen=True)
class Scatter:
    """covariance (P, P) of an estimate from its scatter between so many blocks; freedom: how many independent squares
    noise would make of it.
    """

    covariance: np.ndarray
    freedom: float
    blocks: int

    @property
    def stated(self) -> np.ndarray:
        """The covariance so that 1.96 standard errors hold 95 % as those of few blocks do: by Student's t."""
        return np.asarray(self.covariance * (stdtrit(self.blocks - 1, 0.975) / WITHIN_95) ** 2)

    def beyond(self, noise: np.ndarray) -> bool:
        """Whether the estimate scatters more than errors of this covariance (P, P) make it, all unknowns together."""
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


def block_scatter(blocks: list[Block]) -> Scatter | None:
    """The scatter of the estimate between blocks; None where there are too few of them.

    With J'J = sum of all blocks = (R R')^-1, what a block b says moves the estimate by R z_b, where
    z_b = (1 - R' J_b' J_b R)^(-1/2) R' J_b' e_b: the root makes up for what the fit has taken of the block's error,
    so that the sum of squares is right on average where the errors are noise (Bell and McCaffrey 2002).
    """
    if len(blocks) < TOLERANCES.statistics.fewest_blocks:
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
    return Scatter(shifts.T @ shifts, int(seen.sum()) ** 2 / squares, len(blocks))
