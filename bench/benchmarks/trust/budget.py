"""How much time there is, in hours of all workers together."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass
class Budget:
    """hours: with the workers that there are. spent: seconds of work that cases of earlier starts took.

    slots: how many workers there are now.
    """

    hours: float
    spent: float
    slots: Callable[[], int]
    now: Callable[[], float] = time.monotonic
    begun: float = field(init=False)

    def __post_init__(self) -> None:
        self.begun = self.now()

    @property
    def seconds(self) -> float:
        """Remaining for every worker, s."""
        return 3600.0 * self.hours - self.spent / self.slots() - (self.now() - self.begun)

    def full(self, pending: float) -> bool:
        """Whether work of so many seconds fills what remains."""
        return pending / self.slots() >= self.seconds
