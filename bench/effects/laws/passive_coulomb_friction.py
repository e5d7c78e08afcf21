"""Coulomb friction in a joint without a motor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import EffectParameter
from bench.effects.passive_joint import PassiveEffect


@dataclass(frozen=True)
class PassiveCoulombFriction(PassiveEffect):
    """Coulomb friction in a passive joint p, carried to the motors by the loops.

    Valid while the joint turns; a bearing under load has more. Source: Briot and Khalil, "Dynamics of Parallel
    Robots", 2015, chapter 8 (principle of virtual work).
    """

    name = "passive_coulomb_friction"
    law = "τ = J_p' Fc sign(q̇_p): coulomb friction in a passive joint p, carried to the motors by the loops."
    symbols = (
        "Fc: Coulomb friction, positive, N·m or N; q̇_p: velocity of the passive joint; J_p (1, n): its "
        "velocity for the motors' velocities."
    )
    shown_by = "move one motor alone, slowly"
    seen = ("opposes",)
    in_key = ("is there at several motors at once, and varies with the pose",)
    parameters = (EffectParameter("Fc", "{effort}", positive=True),)
    in_mjcf = "frictionloss"

    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:  # noqa: ARG002 - of the velocity alone
        return np.sign(velocity)[:, None]
