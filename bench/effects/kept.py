"""Rows that were computed before, kept for when they are asked for again."""

from collections.abc import Hashable

import numpy as np

MOST_BYTES = 32_000_000


class KeptRows:
    """Arrays (M, n, k) by what they follow from; the oldest are forgotten where all would be too large.

    Only columns with anything in them take memory.
    """

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._parts: dict[Hashable, tuple[tuple[int, ...], np.ndarray, np.ndarray]] = {}
        self._bytes = 0
        self._most = most_bytes

    def get(self, key: Hashable) -> np.ndarray | None:
        """The array kept for this key, None where there is none. Raises TypeError where it cannot be a key."""
        part = self._parts.get(key)
        if part is None:
            return None
        shape, filled, values = part
        rows = np.zeros((shape[0], shape[1] * shape[2]))
        rows[:, filled] = values
        return rows.reshape(shape)

    def keep(self, key: Hashable, rows: np.ndarray) -> None:
        """Keep an array (M, n, k)."""
        flat = rows.reshape(len(rows), -1)
        filled = np.flatnonzero(flat.any(axis=0))
        values = flat[:, filled]
        if values.nbytes > self._most or key in self._parts:
            return
        self._parts[key] = (rows.shape, filled, values)
        self._bytes += values.nbytes
        while self._bytes > self._most:
            self._bytes -= self._parts.pop(next(iter(self._parts)))[2].nbytes
