"""A state that follows what drives it with a time constant."""

import numpy as np

LARGEST = 300.0  # of an exponent: numbers up to exp(700) can be held


def first_order(driven: np.ndarray, rate: float, duration: float) -> np.ndarray:
    """z (N,) with dz/dt = (x - z) / T and z = 0 at the start, of x = `driven` (N,) sampled at `rate` Hz; T s.

    Exact where x is a straight line between samples. Sums of what was gained, each in units of what remains of it at
    the end of a block, so that a block needs no loop.
    """
    step = 1.0 / (rate * duration)
    gained = -np.expm1(-step)
    new = 1.0 - gained / step
    added = np.append(0.0, new * driven[1:] + (gained - new) * driven[:-1])
    length = int(LARGEST / step)
    if not length:  # nothing remains after a sample
        return added
    growth = np.exp(step * np.arange(1, min(length, len(added)) + 1))
    values = np.empty(len(added))
    last = 0.0
    for at in range(0, len(added), length):
        block = added[at : at + length]
        grown = growth[: len(block)]
        values[at : at + length] = (last + np.cumsum(block * grown)) / grown
        last = values[at + len(block) - 1]
    return values
