"""Friction of a grease that thins under shear, as a torque law."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class ShearThinningFriction(JointEffect):
    """Fa · ln(x + √(x² + 1)) · sign(q̇) with x = |q̇|/va (Eyring's law).

    Fa: N·m or N, at least 0.  va: rad/s or m/s.
    """

    name = "shear_thinning_friction"
    law = "Fa asinh(q̇/va)"
    positive = ("va",)
    not_negative = ("Fa",)
    Fa: float
    va: float

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        def friction() -> np.ndarray:
            x = np.abs(s.velocity) / p["va"]
            return np.asarray(np.sign(s.velocity) * p["Fa"] * np.log(x + np.sqrt(x**2 + 1.0)))

        return friction

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        """Nonlinear above a fifth of the RMS speed."""
        va = 0.2 * rms(j.velocity)
        return {"Fa": share * rms(j.torque) / rms(np.arcsinh(j.velocity / va)), "va": va}
