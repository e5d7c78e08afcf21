"""Inertia of the motor's rotor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class RotorInertia(ActuatorEffect):
    """Inertia of rotor and gear, seen at the joint (rotor inertia times the gear ratio squared).

    Valid for a stiff gear. If the motor is on the base, the first link's inertia absorbs it; elsewhere it is among the
    model's base parameters, as Ia(joint). Source: Khalil and Dombre, "Modeling, Identification and Control of Robots",
    2002, 9.3.
    """

    name = "rotor_inertia"
    law = (
        "τ = Ia q̈: inertia of rotor and gear, seen at the joint (rotor inertia times the gear ratio squared)."
    )
    symbols = "Ia: positive, kg·m² or kg."
    shown_by = "carry a second payload"
    seen = ("acceleration",)
    in_key = ("is in proportion to the motor's own acceleration",)
    parameters = (EffectParameter("Ia", "{effort}*s^2/{angle}", positive=True),)
    of_instant = True

    def torque(self, joint: JointSignals) -> np.ndarray:
        return joint.acceleration[:, None]
