"""Dry friction proportional to the load of the drive."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals

MOST = 0.7  # more could not be distinguished from the load


@dataclass(frozen=True)
class LoadDependentFriction(ActuatorEffect):
    """Loss of a gear under load, proportional to the motor's torque.

    Valid for mu well below one, away from standstill. Source: Hamon, Gautier and Garrec, "Dynamic identification of
    robots with a dry friction model depending on load and velocity", IROS 2010.
    """

    name = "load_dependent_friction"
    law = (
        "τ = mu |τ_m| sign(q̇), τ_m = τ_l + τ: what a gear under load loses, proportional to the motor's "
        "torque."
    )
    symbols = (
        "mu: dimensionless, positive; 1 − mu is about the gear's efficiency. τ_l: load, the torque that the "
        "present model needs, this friction aside; were it made of the current itself, that would be "
        "explained by itself. With x = sign(τ_m q̇) the motor needs τ_m = τ_l / (1 − mu x), so that the "
        "column is x τ_l / (1 − mu x), about mu = 0 the load's size against the motion; only x, whether the "
        "motor drives or brakes, is taken from the current."
    )
    shown_by = "carry a second payload"
    seen = ("load", "opposes")
    in_key = ("grows with the torque of the motor", "")
    parameters = (EffectParameter("mu", "1", positive=True, below=MOST),)
    by_motor = True
    depends_on_model = True
    every_sample = True
    before_torque = True
    of_instant = True

    mu: float = 0.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        drives = np.sign(joint.motor_torque * joint.velocity)
        share = float(np.clip(self.mu, -MOST, MOST))
        return (drives * joint.needed_torque / (1.0 - share * drives))[:, None]
