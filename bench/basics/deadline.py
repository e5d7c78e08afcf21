"""A deadline after which long work ends with the best answer so far; numeric code checks it between its steps."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass


class TimeUpError(Exception):
    """The time is up. It is caught by a caller that has an answer, the best so far."""


@dataclass(frozen=True)
class Deadline:
    """Work ends when `clock` reaches `ends`, both in s; the clock is monotonic."""

    ends: float
    clock: Callable[[], float] = time.monotonic

    @property
    def passed(self) -> bool:
        """Whether the time is up."""
        return self.clock() >= self.ends

    def check(self) -> None:
        """Raise TimeUpError if the time is up."""
        if self.passed:
            raise TimeUpError


NEVER = Deadline(math.inf)


def deadline_in(seconds: float | None, clock: Callable[[], float] = time.monotonic) -> Deadline:
    """The deadline `seconds` from now; NEVER for None."""
    return NEVER if seconds is None else Deadline(clock() + seconds, clock)
