"""A current that acts later than it is commanded, or was logged later."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.truth.hidden.base import Array, JointEffect
from bench.truth.hidden.signals import Law, Parameters, Signals


@dataclass(frozen=True)
class CurrentDelay(JointEffect):
    """τ(t) = g i(t - T), i as logged.

    T > 0: the drive acts late. T < 0: it acts at once, and the current reference was logged |T| late.
    Between two steps the reference is interpolated linearly.

    T: s, either sign.
    """

    name: ClassVar[str] = "current_delay"
    T: float

    @staticmethod
    def log(p: Parameters, s: Signals) -> Law | None:
        return delayed(s.current, np.maximum(-p["T"], 0.0) / s.step)

    @staticmethod
    def current(p: Parameters, s: Signals) -> Law | None:
        return delayed(s.current, np.maximum(p["T"], 0.0) / s.step)


def delayed(signal: Array, steps: Array) -> Law | None:
    """A law that gives `signal` (R, m) as it was `steps` (m,) calls ago; None if that is never.

    Before its first call the signal was what it is then.
    """
    if not steps.any():
        return None
    whole = np.floor(steps).astype(int)
    share = steps - whole
    column = np.arange(len(steps))
    count = int(whole.max()) + 2
    ring = np.zeros((count, *signal.shape))
    calls = 0

    def law() -> Array:
        nonlocal calls
        if calls == 0:
            ring[:] = signal
        ring[calls % count] = signal
        newer = ring[(calls - whole) % count, :, column].T
        older = ring[(calls - whole - 1) % count, :, column].T
        calls += 1
        return newer + share * (older - newer)

    return law
