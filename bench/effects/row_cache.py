"""Rows that were computed before, kept for when they are asked for again."""

from collections.abc import Hashable

import numpy as np

MOST_BYTES = 20_000_000


class KeptRows:
    """Arrays (M, n, k) by what they follow from; those not asked for the longest go where all are too large.

    Where most columns are zero, as those of an effect at one motor are, only the others take memory.
    """

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._parts: dict[Hashable, tuple[tuple[int, ...], np.ndarray | None, np.ndarray]] = {}
        self._bytes = 0
        self._most = most_bytes

    @property
    def nbytes(self) -> int:
        """What is kept takes so much."""
        return self._bytes

    def get(self, key: Hashable) -> np.ndarray | None:
        """The array kept for this key, not to be changed; None where there is none.

        Raises TypeError where it cannot be a key.
        """
        part = self._parts.pop(key, None)
        if part is None:
            return None
        self._parts[key] = part
        shape, filled, values = part
        if filled is None:
            return values
        rows = np.zeros((shape[0], shape[1] * shape[2]))
        rows[:, filled] = values
        return rows.reshape(shape)

    def keep(self, key: Hashable, rows: np.ndarray) -> None:
        """Keep an array (M, n, k), which nobody may change from now on."""
        flat = rows.reshape(len(rows), -1)
        filled = np.flatnonzero(flat.any(axis=0))
        sparse = 2 * len(filled) < flat.shape[1]
        values = flat[:, filled] if sparse else rows
        if values.nbytes > self._most or key in self._parts:
            return
        self._parts[key] = (rows.shape, filled if sparse else None, values)
        self._bytes += values.nbytes
        while self._bytes > self._most:
            self._bytes -= self._parts.pop(next(iter(self._parts)))[2].nbytes

    def forget(self) -> None:
        """Keep none of them."""
        self._parts.clear()
        self._bytes = 0
