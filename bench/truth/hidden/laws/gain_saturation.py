"""A drive gain that falls as the current rises."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class GainSaturation(JointEffect):
    """τ = g i (1 - k i²): magnetic saturation.

    Valid for |i| < 1 / √(3 k), where the torque still rises with the current; beyond, the controller loses the robot.

    k: 1 / (drive unit)², at least 0.
    """

    name = "gain_saturation"
    shares = (0.01, 0.1)
    law = "τ = g i (1 − k i²)"
    not_negative = ("k",)
    k: float

    @staticmethod
    def gain(p: Parameters, s: Signals) -> Law:
        return lambda: 1.0 - p["k"] * s.current**2

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        k = share * rms(j.current) / rms(j.current**3)
        # the largest torque is 2/3 of g / √(3 k); a fifth of it is reserved for the controller
        if 3 * k * np.abs(j.current).max() ** 2 > (0.8 * 2 / 3) ** 2:
            raise j.too_large("gain_saturation", share, "the motor could not give the greatest torque")
        return {"k": k}
