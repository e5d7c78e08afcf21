"""Viscous friction that depends on the direction of motion, as a torque law."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class AsymmetricViscousFriction(JointEffect):
    """Fv_plus · q̇ for q̇ > 0, Fv_minus · q̇ for q̇ < 0.

    Fv_plus, Fv_minus: N·m·s/rad or N·s/m, at least 0.
    """

    name = "asymmetric_viscous_friction"
    law = "Fv_plus q̇ for q̇ > 0, Fv_minus q̇ for q̇ < 0"
    not_negative = ("Fv_plus", "Fv_minus")
    Fv_plus: float
    Fv_minus: float

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        return lambda: np.where(s.velocity > 0, p["Fv_plus"], p["Fv_minus"]) * s.velocity

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        """The coefficient for negative velocities is twice that for positive ones."""
        unit = rms(np.where(j.velocity > 0, 1.0, 2.0) * j.velocity)
        return {"Fv_plus": share * rms(j.torque) / unit, "Fv_minus": 2 * share * rms(j.torque) / unit}
