"""Indices into coordinates, and views of the columns that they name."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.signedinteger]


def as_slice(indices: Indices) -> slice | None:
    """The slice that names the same places as indices (m,), rising by an even amount; None if there is none."""
    if len(indices) == 1:
        return slice(int(indices[0]), int(indices[0]) + 1)
    steps = np.diff(indices)
    if steps[0] <= 0 or (steps != steps[0]).any():
        return None
    return slice(int(indices[0]), int(indices[-1]) + 1, int(steps[0]))


def live_columns(source: Array, indices: Indices) -> tuple[Array, Callable[[], object] | None]:
    """Columns of source (R, …) as (R, m), and what keeps them up to date; None where they are a view."""
    columns = as_slice(indices)
    if columns is not None:
        return source[:, columns], None
    copy = source[:, indices]
    return copy, lambda: np.take(source, indices, axis=1, out=copy)
