"""Viscous friction."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class ViscousFriction(ActuatorEffect):
    """Friction proportional to the velocity qd, as of an oil film.

    Valid away from standstill, at constant temperature. Source: Khalil and Dombre, "Modeling, Identification and
    Control of Robots", 2002, 9.3.
    """

    name = "viscous_friction"
    law = "τ = Fv q̇: friction proportional to the velocity q̇, as of an oil film."
    symbols = "Fv: viscous friction coefficient, positive, N·m·s/rad or N·s/m."
    shown_by = "move fast and slowly"
    seen = ("velocity",)
    in_key = ("a straight line",)
    varies_by_run = True
    of_velocity = True
    parameters = (EffectParameter("Fv", "{effort}*s/{angle}", positive=True),)
    by_motor = True
    in_mjcf = "damping"

    def torque(self, joint: JointSignals) -> np.ndarray:
        return joint.velocity[:, None]
