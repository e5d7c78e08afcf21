"""Current that acts, or was logged, late or early."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals
from bench.signals.differentiation import central_difference

LONGEST = 0.1  # s
SHORTEST = 1e-6  # s: below it the column is the derivative


@dataclass(frozen=True)
class CurrentDelay(ActuatorEffect):
    """The current acts a time T after it was logged, or before it where T is negative.

    The column is (tau(t + T) - tau(t)) / T, for T = 0 the derivative; a column of the current itself would also fit the
    current's noise. Valid for T up to 0.1 s; if T times the highest angular frequency of the current is small, a
    first-order lag of the same time has the same effect. Source: Ljung, "System Identification", 1999, chapter 4 (pure
    delay, output error).
    """

    name = "current_delay"
    law = (
        "g i(t) = τ(t + T): the current acts a time T after it was logged, or before it where T is negative."
    )
    symbols = "T: s, of either sign; τ: torque that the present model needs, interpolated between samples."
    shown_by = "reverse fast"
    seen = ("current", "velocity")
    in_key = (
        "largest where the current changes fast; over the usual motions the two are the same",
        "a line in a wide band, since it is the current's change that counts",
    )
    parameters = (EffectParameter("T", "s"),)
    by_motor = True
    depends_on_model = True
    before_torque = True
    every_sample = True

    T: float = 0.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        late = float(np.clip(self.T, -LONGEST, LONGEST))
        needed = joint.needed_torque
        if abs(late) < SHORTEST:
            return central_difference(needed, 1.0 / joint.rate, 2)[:, None]
        return ((delayed(needed, -late * joint.rate) - needed) / late)[:, None]


def delayed(values: np.ndarray, samples: float) -> np.ndarray:
    """Values (N,) delayed by `samples` (advanced if negative), cubic between four neighbours, ends mirrored."""
    whole = int(np.floor(samples))
    u = 1.0 - (samples - whole)  # from the sample whole + 1 earlier towards the one whole earlier
    weights = (
        -u * (u - 1.0) * (u - 2.0) / 6.0,
        (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
        -(u + 1.0) * u * (u - 2.0) / 2.0,
        (u + 1.0) * u * (u - 1.0) / 6.0,
    )
    reach = abs(whole) + 3
    padded = np.pad(values, reach, mode="reflect", reflect_type="odd")
    first = reach - whole - 2
    parts = [weight * padded[first + i : first + i + len(values)] for i, weight in enumerate(weights)]
    return np.asarray(sum(parts))
