"""How many effects a page has room for, and with how many digits."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.workbench.system import PageSystem

FULL, SHORT = 4, 2  # bytes of a number
MOST_BYTES, MOST_SHORT_BYTES = 800_000, 900_000  # of all triangles together, at full length and at half


@dataclass(frozen=True)
class PageRoom:
    """short: whether numbers are carried at half their length. without: effects that there is no room for."""

    short: bool
    without: frozenset[str]

    def kept(self, system: PageSystem) -> np.ndarray:
        """Which columns are carried for each motor (n, C): those that are more than zero there."""
        return _kept(system, self.without)


def room_for(systems: Sequence[PageSystem], ranks: Mapping[str, int]) -> PageRoom:
    """Room for the equations of all these systems, which have the same effects; the last in rank go first."""
    if _numbers(systems, ()) * FULL <= MOST_BYTES:
        return PageRoom(False, frozenset())
    names = sorted({instance.effect.name for instance in systems[0].effects}, key=lambda name: ranks[name])
    left: list[str] = []
    while names and _numbers(systems, left) * SHORT > MOST_SHORT_BYTES and ranks[names[-1]] >= 0:
        left.append(names.pop())
    return PageRoom(True, frozenset(left))


def _kept(system: PageSystem, without: Collection[str]) -> np.ndarray:
    kept = system.filled()
    for start, stop, instance in zip(system.starts, system.starts[1:], system.effects, strict=False):
        if instance.effect.name in without:
            kept[:, start:stop] = False
    return kept


def _numbers(systems: Sequence[PageSystem], without: Collection[str]) -> int:
    """In the triangles of all motors: of the fitted rows, and of the judged ones where there are any."""
    found = 0
    for system in systems:
        uses = 1 if system.fitted.all() else 2
        counts = _kept(system, without).sum(axis=1) + 2
        found += uses * int((counts * (counts + 1) // 2).sum())
    return found
