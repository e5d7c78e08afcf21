"""A drive gain that is periodic in the position of the motor."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, harmonic


@dataclass(frozen=True)
class TorqueRipple(JointEffect):
    """τ = g i (1 + a · cos(2π q / period) + b · sin(2π q / period)): windings that differ.

    a, b: shares of the torque.  period: rad or m.
    """

    name = "torque_ripple"
    law = "τ = g i (1 + a cos(2πq / period) + b sin(2πq / period))"
    positive = ("period",)
    a: float
    b: float
    period: float

    @staticmethod
    def gain(p: Parameters, s: Signals) -> Law:
        wave_number = 2 * np.pi / p["period"]
        return lambda: 1.0 + harmonic(p, s.position, wave_number)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"a": 0.0, "b": np.sqrt(2) * share, "period": j.span / 6}
