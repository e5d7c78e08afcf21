"""What a small change adds to the observation matrix, kept without the columns that it leaves as they are."""

from dataclasses import dataclass

import numpy as np

KEPT = np.float32  # small changes need no more digits


@dataclass(frozen=True)
class SmallChange:
    """K samples of n motors and p columns each; filled (c,): which of all n p change, values (K, c): by how much."""

    filled: np.ndarray
    values: np.ndarray
    shape: tuple[int, int]

    def rows(self, part: slice) -> np.ndarray:
        """What is added at some of the samples, (P, n, p)."""
        values = self.values[part]
        rows = np.zeros((len(values), self.shape[0] * self.shape[1]), dtype=KEPT)
        rows[:, self.filled] = values
        return rows.reshape(-1, *self.shape)


def small_change(rows: np.ndarray) -> SmallChange:
    """The small change of what is added to every column, (K, n, p)."""
    samples, n, p = rows.shape
    flat = rows.astype(KEPT, order="C").reshape(samples, n * p)
    filled = np.flatnonzero(flat.any(axis=0))
    return SmallChange(filled, flat[:, filled], (n, p))
