"""Random streams that are independent of each other and of the order in which they are used."""

from zlib import crc32

import numpy as np


def stream(seed: int, *keys: str) -> np.random.Generator:
    """The random stream of a seed and a path of names, such as ("unloaded", "current.left").

    Adding a recording or removing a channel does not change any other stream.
    """
    spawn_key = tuple(crc32(key.encode()) for key in keys)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=spawn_key))
