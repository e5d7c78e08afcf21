"""Numbers as initialisers of C, to the last bit."""

from collections.abc import Sequence

import numpy as np


def table(values: np.ndarray | Sequence[object]) -> str:
    """The text between the braces of an array, of one dimension or two."""
    array = np.asarray(values)
    if array.ndim == 2:
        return ",\n    ".join("{" + table(row) + "}" for row in array)
    return ", ".join(repr(value) for value in array.tolist())
