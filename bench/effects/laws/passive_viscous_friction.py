"""Viscous friction in a joint without a motor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.passive_joint import passive_velocity, seen_by_motors
from bench.effects.signals import RobotSignals


@dataclass(frozen=True)
class PassiveViscousFriction(Effect):
    """Viscous friction in a passive joint p, carried to the motors by the loops.

    Valid at constant temperature. Source: Briot and Khalil, "Dynamics of Parallel Robots", 2015, chapter 8
    (principle of virtual work).
    """

    name = "passive_viscous_friction"
    law = "τ = J_p' Fv q̇_p: viscous friction in a passive joint p, carried to the motors by the loops."
    symbols = (
        "Fv: viscous friction coefficient, positive, N·m·s/rad or N·s/m; q̇_p: velocity of the passive "
        "joint; J_p (1, n): its velocity for the motors' velocities."
    )
    shown_by = "move one motor alone, fast"
    seen = ("velocity",)
    in_key = ("a line whose slope depends on the pose, at several motors",)
    parameters = (EffectParameter("Fv", "{effort}*s/{angle}", positive=True),)
    place = "passive"

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        speed = passive_velocity(robot, joint)
        return seen_by_motors(robot, joint, speed)[:, :, None]
