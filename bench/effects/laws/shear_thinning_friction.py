"""Viscous friction of a lubricant that thins under shear."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter, ShapeParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class ShearThinningFriction(ActuatorEffect):
    """Viscous friction that grows less than the velocity does, as in greased gears and harmonic drives.

    Valid in the lubricated range, at constant temperature; a va far above the speeds of the motion looks like
    viscous friction. Source: Eyring, "Viscosity, plasticity, and diffusion as examples of absolute reaction rates",
    Journal of Chemical Physics 4, 1936 (the law of the film); Waiboer, Aarts and Jonker, "Velocity dependence of joint
    friction in robotic manipulators with gear transmissions", ECCOMAS Multibody Dynamics 2005 (in robot joints).
    """

    name = "shear_thinning_friction"
    law = (
        "τ = Fa asinh(q̇/va): viscous friction that grows less than the velocity does, as of a gear's grease."
    )
    symbols = (
        "Fa: positive, N·m or N; va: velocity from which on the grease thins, rad/s or m/s, estimated from the data. "
        "Far below va it is viscous friction with the coefficient Fa/va, far above it the friction grows by Fa "
        "wherever the velocity grows by the factor e."
    )
    shown_by = "move fast and slowly"
    seen = ("velocity",)
    in_key = ("bent, steep at low speeds and flatter at high ones",)
    of_velocity = True
    parameters = (EffectParameter("Fa", "{effort}", positive=True),)
    by_motor = True
    shape = (ShapeParameter("va", "{angle}/s", (0.1, 0.2, 0.4, 0.8, 1.6, 3.2), scale="speed"),)
    contains = ("viscous_friction",)

    va: float = 0.5

    def torque(self, joint: JointSignals) -> np.ndarray:
        return np.arcsinh(joint.velocity / self.va)[:, None]
