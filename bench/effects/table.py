"""A function by its values at some points, linear between them."""

import numpy as np


def hat(x: np.ndarray, before: float, at: float, after: float) -> np.ndarray:
    """Weight (N,) of a table's value at `at` for x (N,): 1 there, falling to 0 at its neighbours.

    At a table's end, where `before` or `after` is `at` itself, it stays 1 beyond.
    """
    rising = (x - before) / (at - before) if before < at else np.ones_like(x)
    falling = (after - x) / (after - at) if after > at else np.ones_like(x)
    return np.asarray(np.clip(np.minimum(rising, falling), 0.0, 1.0))
