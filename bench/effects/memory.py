"""A state that follows its input with a time constant."""

import numpy as np

LARGEST = 300.0  # of an exponent: floats reach exp(700)


def first_order(driven: np.ndarray, rate: float, duration: float) -> np.ndarray:
    """z (N,) with dz/dt = (x - z) / T and z = 0 at the start, of x = `driven` (N,) sampled at `rate` Hz; T s.

    Exact for x linear between samples. Sums the increments in a block, each scaled by its decay to the end of the
    block, without a loop.
    """
    step = 1.0 / (rate * duration)
    gained = -np.expm1(-step)
    new = 1.0 - gained / step
    added = np.append(0.0, new * driven[1:] + (gained - new) * driven[:-1])
    length = int(LARGEST / step)
    if not length:  # decays within a sample
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
