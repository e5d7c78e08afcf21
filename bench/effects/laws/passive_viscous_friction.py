"""Viscous friction in a joint without a motor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import EffectParameter
from bench.effects.passive_joint import PassiveEffect


@dataclass(frozen=True)
class PassiveViscousFriction(PassiveEffect):
    """Viscous friction in a passive joint p, carried to the motors by the loops.

    Valid at constant temperature; for balls at both ends of a rod if they have the same friction, and this friction,
    not inertia, limits the rod's spin about its line (`bench.model.body_rates`). Source: Briot and Khalil, "Dynamics of
    Parallel Robots", 2015, chapter 8 (principle of virtual work).
    """

    name = "passive_viscous_friction"
    law = "τ = J_p' Fv q̇_p: viscous friction in a passive joint p, carried to the motors by the loops."
    symbols = (
        "Fv: viscous friction coefficient, positive, N·m·s/rad or N·s/m; q̇_p: velocity of the passive "
        "joint, of a ball joint its angular velocity (3); J_p (1, n) or (3, n): that for the motors' velocities."
    )
    shown_by = "move one motor alone, fast"
    seen = ("velocity",)
    in_key = ("a line whose slope depends on the pose, at several motors",)
    parameters = (EffectParameter("Fv", "{effort}*s/{angle}", positive=True),)
    by_motor = True
    in_balls = True
    in_mjcf = "damping"

    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:  # noqa: ARG002 - of the velocity alone
        return velocity[:, :, None]
