"""Cache of computed rows."""

from collections.abc import Hashable
from math import prod
from typing import Generic, TypeVar

import numpy as np

MOST_BYTES = 20_000_000
Value = TypeVar("Value")


class LeastAsked(Generic[Value]):
    """Values by key; the least recently used are dropped if all are too large."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._parts: dict[Hashable, tuple[Value, int]] = {}
        self._bytes = 0
        self._most = most_bytes

    @property
    def nbytes(self) -> int:
        """Total size of the values."""
        return self._bytes

    def get(self, key: Hashable) -> Value | None:
        """The value for this key, not to be changed; None if there is none.

        Raises TypeError if it cannot be a key.
        """
        part = self._parts.pop(key, None)
        if part is None:
            return None
        self._parts[key] = part
        return part[0]

    def keep(self, key: Hashable, value: Value, nbytes: int) -> None:
        """Keep a value of `nbytes`, which nobody may change from now on."""
        if nbytes > self._most or key in self._parts:
            return
        self._parts[key] = value, nbytes
        self._bytes += nbytes
        while self._bytes > self._most:
            self._bytes -= self._parts.pop(next(iter(self._parts)))[1]

    def forget(self) -> None:
        """Keep none of them."""
        self._parts.clear()
        self._bytes = 0


class KeptRows:
    """Arrays (M, ...) as `LeastAsked` has them.

    Zero columns, of which an effect at one motor has many, take no memory.
    """

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._kept = LeastAsked[tuple[tuple[int, ...], np.ndarray | None, np.ndarray]](most_bytes)

    @property
    def nbytes(self) -> int:
        """See `LeastAsked`."""
        return self._kept.nbytes

    def get(self, key: Hashable) -> np.ndarray | None:
        """See `LeastAsked`."""
        part = self._kept.get(key)
        if part is None:
            return None
        shape, filled, values = part
        if filled is None:
            return values
        rows = np.zeros((shape[0], prod(shape[1:])))
        rows[:, filled] = values
        return rows.reshape(shape)

    def keep(self, key: Hashable, rows: np.ndarray) -> None:
        """Keep an array (M, ...), which nobody may change from now on."""
        flat = rows.reshape(len(rows), -1)
        filled = np.flatnonzero(flat.any(axis=0))
        sparse = 2 * len(filled) < flat.shape[1]
        values = flat[:, filled] if sparse else rows
        self._kept.keep(key, (rows.shape, filled if sparse else None, values), values.nbytes)

    def forget(self) -> None:
        """See `LeastAsked`."""
        self._kept.forget()
