"""Which columns of a noise-free matrix are independent, decided at a gap of its singular values."""

from dataclasses import dataclass

import numpy as np

from bench.basics.errors import BenchError
from bench.model.bounds import RANKS


class UndecidedRankError(BenchError):
    """No gap of the singular values decides the rank; columns: those in doubt."""

    def __init__(self, columns: np.ndarray) -> None:
        super().__init__(
            f"no gap of the singular values decides whether columns {columns.tolist()} are independent"
        )
        self.columns = columns


@dataclass(frozen=True)
class IndependentColumns:
    """kept (b,): indices of the independent columns. dependence (b, p): matrix = matrix[:, kept] @ dependence.
    neglected: the largest share of the matrix that counts as slack of a drawing; 0 where all else is rounding.
    """

    kept: np.ndarray
    dependence: np.ndarray
    neglected: float


def independent_columns(rows: np.ndarray) -> IndependentColumns:
    """Which columns of rows (r, p) are independent of those before them, and how the others follow.

    Every row counts alike, whatever its size: rows near a singular pose are a million times larger. The rank is where
    the singular values, columns of unit length, fall by a gap to less than the slack; a column counts as zero after
    such a gap of the columns' sizes: a planar robot is drawn a little out of its plane, and the parameters of that
    slack are none. Raises UndecidedRankError where no gap decides.
    """
    rows = _rows_alike(rows)
    norms = np.linalg.norm(rows, axis=0)
    large = _rank(np.sort(norms)[::-1])
    present = np.sort(np.argsort(-norms, kind="stable")[:large])
    scaled = rows[:, present] / norms[present]
    _, values, directions = np.linalg.svd(scaled, full_matrices=False)
    rank = _rank(values)
    if rank and values[rank - 1] < RANKS.rounding * values[0]:
        raise UndecidedRankError(present[np.abs(directions[rank - 1]) > RANKS.coefficient])
    slack = float((values[rank:] / values[rank - 1 : rank]).max(initial=0.0))
    directions = directions[:rank]
    kept = _first_independent(directions, max(RANKS.clear, RANKS.gap * slack))
    coefficients = np.linalg.solve(directions[:, kept], directions)
    coefficients[np.abs(coefficients) < RANKS.coefficient] = 0.0
    dependence = np.zeros((rank, rows.shape[1]))
    dependence[:, present] = coefficients * norms[present] / norms[present[kept]][:, None]
    dependence[np.arange(rank), present[kept]] = 1.0
    absent = np.delete(norms, present)
    neglected = max(
        (values[rank:] / values[:1]).max(initial=0.0),
        absent.max(initial=0.0) / (norms.max(initial=0.0) or 1.0),
    )
    return IndependentColumns(
        present[kept], dependence, float(neglected) if neglected > RANKS.rounding else 0.0
    )


def _first_independent(columns: np.ndarray, least: float) -> list[int]:
    """The numbers of the first r columns (r, p) that are independent of those before them; r is their rank.

    A column of which less than `least` is independent counts only where there are not enough others.
    """
    while True:
        kept: list[int] = []
        basis = np.zeros((columns.shape[0], 0))
        sizes = np.zeros(columns.shape[1])
        for place, column in enumerate(columns.T):
            remainder = column - basis @ (basis.T @ column)
            remainder -= basis @ (basis.T @ remainder)
            sizes[place] = np.linalg.norm(remainder)
            if sizes[place] >= least and len(kept) < len(columns):
                kept.append(place)
                basis = np.hstack((basis, (remainder / sizes[place])[:, None]))
        if len(kept) == len(columns):
            return kept
        least = float(np.delete(sizes, kept).max())


def _rows_alike(rows: np.ndarray) -> np.ndarray:
    """Rows (r, p) of unit length, columns of any unit counted alike."""
    norms = np.linalg.norm(rows, axis=0)
    sizes = np.linalg.norm(rows / np.where(norms > 0.0, norms, 1.0), axis=1)
    return np.asarray(rows / np.where(sizes > 0.0, sizes, 1.0)[:, None])


def _rank(values: np.ndarray) -> int:
    """How many of the descending values (k,) come before the first gap to less than the slack."""
    below = values[1:] < RANKS.slack * values[:1]
    gaps = np.flatnonzero(below & (values[:-1] > RANKS.gap * values[1:]))
    return int(gaps[0]) + 1 if len(gaps) else int(np.count_nonzero(values))
