"""Inertia of the motor's rotor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class RotorInertia(ActuatorEffect):
    """tau = Ia qdd: inertia of rotor and gear, seen at the joint (rotor inertia times the gear ratio squared).

    Ia: positive, kg*m2 or kg. Valid for a stiff gear. Where the motor stands on the base it moves with the first
    link, whose inertia takes it up; elsewhere it is among the model's base parameters, as Ia(joint). Source: Khalil
    and Dombre, "Modeling, Identification and Control of Robots", 2002, 9.3.
    """

    name = "rotor_inertia"
    parameters = (EffectParameter("Ia", "{effort}*s^2/{angle}", positive=True),)

    def torque(self, joint: JointSignals) -> np.ndarray:
        return joint.acceleration[:, None]
