"""Coulomb friction."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class CoulombFriction(ActuatorEffect):
    """Dry friction of constant size against the motion.

    Valid while the joint slides; around standstill the real friction is a spring before it slides. Source: Khalil
    and Dombre, "Modeling, Identification and Control of Robots", 2002, 9.3.
    """

    name = "coulomb_friction"
    law = "τ = Fc sign(q̇): dry friction of constant size against the motion."
    symbols = "Fc: Coulomb friction, positive, N·m or N."
    shown_by = "reverse slowly"
    seen = ("opposes",)
    in_key = ("is the same at all speeds",)
    varies_by_run = True
    of_velocity = True
    parameters = (EffectParameter("Fc", "{effort}", positive=True),)
    by_motor = True
    in_mjcf = "frictionloss"

    def torque(self, joint: JointSignals) -> np.ndarray:
        return np.sign(joint.velocity)[:, None]
