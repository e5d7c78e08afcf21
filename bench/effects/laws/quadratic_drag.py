"""Drag that grows with the square of the speed."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class QuadraticDrag(ActuatorEffect):
    """Resistance of displaced air or oil.

    Valid for turbulent flow; slow motion in a fluid is viscous. Source: White, "Fluid Mechanics", 2011, chapter 7
    (drag of immersed bodies).
    """

    name = "quadratic_drag"
    law = "τ = c q̇ |q̇|: resistance of air or oil that is pushed aside."
    symbols = "c: positive, N·m·s²/rad² or N·s²/m²."
    shown_by = "move as fast as allowed"
    seen = ("velocity",)
    in_key = ("bent, small at low speeds",)
    of_velocity = True
    parameters = (EffectParameter("c", "{effort}*s^2/{angle}^2", positive=True),)
    by_motor = True

    def torque(self, joint: JointSignals) -> np.ndarray:
        return (joint.velocity * np.abs(joint.velocity))[:, None]
