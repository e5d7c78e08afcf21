"""Coulomb friction in a joint without a motor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import EffectParameter
from bench.effects.passive_joint import PassiveEffect


@dataclass(frozen=True)
class PassiveCoulombFriction(PassiveEffect):
    """Coulomb friction in a passive joint p, carried to the motors by the loops.

    In a ball joint it opposes the angular velocity in any direction. MuJoCo's frictionloss brakes each of a ball's
    three coordinates separately, up to 1.7 times as much about one axis as about another, depending on the ball's frame
    in its body, which spins with a rod: no fit can determine this frame, and no real ball has one. The simulated
    machine reads the frictionloss of a ball as this law. Valid while the joint turns; for balls at both ends of a rod
    if they have nearly the same friction, see `bench.model.body_rates`; a bearing under load has more. Source: Briot
    and Khalil, "Dynamics of Parallel Robots", 2015, chapter 8 (principle of virtual work).
    """

    name = "passive_coulomb_friction"
    law = "τ = J_p' Fc q̇_p/|q̇_p|: coulomb friction in a passive joint p, carried to the motors by the loops."
    symbols = (
        "Fc: Coulomb friction, positive, N·m or N; q̇_p: velocity of the passive joint, of a ball "
        "joint its angular velocity (3); J_p (1, n) or (3, n): that for the motors' velocities."
    )
    shown_by = "move one motor alone, slowly"
    seen = ("opposes",)
    in_key = ("is there at several motors at once, and varies with the pose",)
    parameters = (EffectParameter("Fc", "{effort}", positive=True),)
    by_motor = True
    in_balls = True
    in_mjcf = "frictionloss"

    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:  # noqa: ARG002 - of the velocity alone
        speed = np.linalg.norm(velocity, axis=1, keepdims=True)
        return np.divide(velocity, speed, out=np.zeros_like(velocity), where=speed > 0.0)[:, :, None]
