"""A drive gain that falls with the current."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals

SOLVING = 8  # rounds: each reduces the error to a third or less
LEAST = 2.0 / 3.0  # of the gain, at the largest torque: with less, more current gives less torque


@dataclass(frozen=True)
class GainSaturation(ActuatorEffect):
    """Iron that saturates, so that the motor gives less torque at large currents.

    The column is the missing torque, g i^3. Valid while k i^2 is well below one. Source: Krause, Wasynczuk and Sudhoff,
    "Analysis of Electric Machinery and Drive Systems", 2002, chapter 1 (magnetic saturation).
    """

    name = "gain_saturation"
    law = "τ = g i (1 − k i²): iron that saturates, so that the motor gives less torque at large currents."
    symbols = (
        "k: positive, 1/A² (or 1/V²); g: drive gain at small currents; i: the current that the torque needs "
        "of the present model takes; were it the measured one, that would be explained by itself."
    )
    shown_by = "carry a second payload, or accelerate harder"
    seen = ("current",)
    in_key = ("a bowl over the current, largest where the current is",)
    parameters = (EffectParameter("k", "1/{drive}^2", positive=True),)
    by_motor = True
    depends_on_model = True
    before_torque = True
    of_instant = True

    k: float = 0.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        unsaturated = joint.needed_torque / joint.gain
        current = unsaturated
        for _ in range(SOLVING if self.k else 0):
            current = unsaturated / np.maximum(1.0 - self.k * current**2, LEAST)
        return (joint.gain * current**3)[:, None]
