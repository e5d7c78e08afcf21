"""Viscous friction that differs with the direction of motion."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class AsymmetricViscousFriction(ActuatorEffect):
    """Viscous friction with a coefficient for each direction.

    Valid away from standstill, at constant temperature. Source: Armstrong-Helouvry, Dupont and Canudas de Wit, "A
    survey of models, analysis tools and compensation methods for the control of machines with friction", Automatica
    30(7), 1994.
    """

    name = "asymmetric_viscous_friction"
    law = (
        "τ = Fv_plus q̇ for q̇ > 0 and Fv_minus q̇ for q̇ < 0: viscous friction with a coefficient for each "
        "direction."
    )
    symbols = "Fv_plus, Fv_minus: positive, N·m·s/rad or N·s/m; equal, they are plain viscous friction."
    shown_by = "move fast in both directions"
    seen = ("velocity",)
    in_key = ("two straight lines, steeper on one side",)
    parameters = (
        EffectParameter("Fv_plus", "{effort}*s/{angle}", positive=True),
        EffectParameter("Fv_minus", "{effort}*s/{angle}", positive=True),
    )
    by_motor = True
    contains = ("viscous_friction",)

    def torque(self, joint: JointSignals) -> np.ndarray:
        return np.column_stack((np.maximum(joint.velocity, 0.0), np.minimum(joint.velocity, 0.0)))
