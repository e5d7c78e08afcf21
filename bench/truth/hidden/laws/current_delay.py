"""A current that acts or is logged with a delay after its command."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import Array, JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms

LONGEST_DELAY = 0.05  # s


@dataclass(frozen=True)
class CurrentDelay(JointEffect):
    """τ(t) = g i(t - T), i as logged.

    T > 0: the drive acts late. T < 0: it acts at once, and the current reference was logged |T| late.
    Between two steps the reference is interpolated linearly.

    T: s, either sign.
    """

    name = "current_delay"
    shares = (0.002, 0.02)
    law = "the current acts T late; T < 0: it was logged |T| late"
    T: float

    @staticmethod
    def log(p: Parameters, s: Signals) -> Law | None:
        return delayed(s.current, np.maximum(-p["T"], 0.0) / s.step)

    @staticmethod
    def current(p: Parameters, s: Signals) -> Law | None:
        return delayed(s.current, np.maximum(p["T"], 0.0) / s.step)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        """A delay in the drive, or in the log if it would destabilise the controller."""
        late = share * rms(j.current) / rms(j.current_rate)
        if late > LONGEST_DELAY:
            raise j.too_large("current_delay", share, f"it would take {1e3 * late:.0f} ms")
        return {"T": late if late * j.damping / j.inertia < 0.4 else -late}


def delayed(signal: Array, steps: Array) -> Law | None:
    """A law that returns `signal` (R, m) as of `steps` (m,) calls ago; None if all are 0. Before the first call, the
    signal counts as constant.
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
