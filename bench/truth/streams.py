"""Random streams that do not depend on each other, nor on the order in which they are used."""

from zlib import crc32

import numpy as np


def stream(seed: int, *keys: str) -> np.random.Generator:
    """The random stream of a seed and a path of names, such as ("unloaded", "current.left").

    One more recording, or one channel less, leaves every other stream as it was.
    """
    spawn_key = tuple(crc32(key.encode()) for key in keys)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=spawn_key))
