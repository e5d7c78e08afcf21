"""A drive gain that falls with the current."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class GainSaturation(ActuatorEffect):
    """tau = g i (1 - k i^2): iron that saturates, so that the motor gives less torque at large currents.

    k: positive, 1/A2 (or 1/V2); g: drive gain at small currents; i: current, low-passed to twice the fit's band.
    The column is the torque that lacks, g i^3. Valid while k i^2 is well below one. Source: Krause, Wasynczuk and
    Sudhoff, "Analysis of Electric Machinery and Drive Systems", 2002, chapter 1 (magnetic saturation).
    """

    name = "gain_saturation"
    parameters = (EffectParameter("k", "1/{drive}^2", positive=True),)
    depends_on_model = True

    def torque(self, joint: JointSignals) -> np.ndarray:
        return (joint.motor_torque**3 / joint.gain**2)[:, None]
