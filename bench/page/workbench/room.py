"""How many effects a page has room for."""

from collections.abc import Collection, Mapping

import numpy as np

from bench.page.workbench.system import PageSystem

MOST_BYTES = 1_400_000  # of all triangles together
NUMBER = 4  # bytes


def without_room(system: PageSystem, ranks: Mapping[str, int]) -> frozenset[str]:
    """The effects that there is no room for in a system's equations.

    The last in rank go first; those identified, of a rank below zero, stay.
    """
    names = sorted({instance.effect.name for instance in system.effects}, key=lambda name: ranks[name])
    dropped: list[str] = []
    while names and ranks[names[-1]] >= 0 and _numbers(system, dropped) * NUMBER > MOST_BYTES:
        dropped.append(names.pop())
    return frozenset(dropped)


def carried_columns(system: PageSystem, without: Collection[str]) -> np.ndarray:
    """Which columns are carried for each motor (n, C): those that are more than zero there."""
    kept = system.filled()
    for start, stop, instance in zip(system.starts, system.starts[1:], system.effects, strict=False):
        if instance.effect.name in without:
            kept[:, start:stop] = False
    return kept


def _numbers(system: PageSystem, without: Collection[str]) -> int:
    """How many numbers the triangles of all motors have: of fitted rows, and of held-out ones if there are any."""
    uses = 1 if system.fitted.all() else 2
    counts = carried_columns(system, without).sum(axis=1) + 2
    return uses * int((counts * (counts + 1) // 2).sum())
