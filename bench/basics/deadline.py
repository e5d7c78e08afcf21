"""When long work is to end with the best answer so far; numeric code asks it between its steps."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass


class TimeUpError(Exception):
    """The time is up: caught by whoever has an answer, which is the best so far."""


@dataclass(frozen=True)
class Deadline:
    """Work is to end once the clock shows `ends`; both in s, of a clock that only goes forwards."""

    ends: float
    clock: Callable[[], float] = time.monotonic

    @property
    def passed(self) -> bool:
        """Whether the time is up."""
        return self.clock() >= self.ends

    def check(self) -> None:
        """Raise TimeUpError where the time is up."""
        if self.passed:
            raise TimeUpError


NEVER = Deadline(math.inf)


def deadline_in(seconds: float | None, clock: Callable[[], float] = time.monotonic) -> Deadline:
    """So many seconds from now; None: never."""
    return NEVER if seconds is None else Deadline(clock() + seconds, clock)
