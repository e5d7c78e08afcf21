"""Dry friction proportional to the load of the drive."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class LoadDependentFriction(ActuatorEffect):
    """tau = mu |g i| sign(qd): what a gear under load loses, proportional to the motor torque g i.

    mu: dimensionless, positive; 1 - mu is about the gear's efficiency. g i: drive gain times current, low-passed
    to twice the fit's band, since the size of noise does not average out. Valid for mu well below one, away
    from standstill. Source: Hamon, Gautier and Garrec, "Dynamic identification of robots with a dry friction
    model depending on load and velocity", IROS 2010.
    """

    name = "load_dependent_friction"
    parameters = (EffectParameter("mu", "1", positive=True),)
    depends_on_model = True

    def torque(self, joint: JointSignals) -> np.ndarray:
        return (np.abs(joint.motor_torque) * np.sign(joint.velocity))[:, None]
