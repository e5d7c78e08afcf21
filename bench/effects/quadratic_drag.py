"""Drag that grows with the square of the speed."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class QuadraticDrag(ActuatorEffect):
    """tau = c qd |qd|: resistance of air or oil that is pushed aside.

    c: positive, N*m*s2/rad2 or N*s2/m2. Valid for turbulent flow; slow motion in a fluid is viscous. Source:
    White, "Fluid Mechanics", 2011, chapter 7 (drag of immersed bodies).
    """

    name = "quadratic_drag"
    parameters = (EffectParameter("c", "{effort}*s^2/{angle}^2", positive=True),)

    def torque(self, joint: JointSignals) -> np.ndarray:
        return (joint.velocity * np.abs(joint.velocity))[:, None]
