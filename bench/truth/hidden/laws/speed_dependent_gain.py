"""A drive gain that falls with the speed; not in the catalogue of effects."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class SpeedDependentGain(JointEffect):
    """τ = g i (1 - |q̇| / v0): an amplifier whose voltage is limited against the back-EMF.

    v0: the speed at which the gain is zero, rad/s or m/s.
    """

    name = "speed_dependent_gain"
    law = "τ = g i (1 − |q̇|/v0)"
    positive = ("v0",)
    in_catalogue = False
    v0: float

    @staticmethod
    def gain(p: Parameters, s: Signals) -> Law:
        return lambda: 1.0 - np.abs(s.velocity) / p["v0"]

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"v0": rms(j.torque * j.velocity) / (share * rms(j.torque))}
