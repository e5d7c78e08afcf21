"""A force at the platform."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.signals import RobotSignals
from bench.effects.tool_motion import tool_motion


@dataclass(frozen=True)
class PlatformForce(Effect):
    """A hose or a cable that pulls at the tool.

    Valid for a light, linear spring. Source: Briot and Khalil, "Dynamics of Parallel Robots", 2015, chapter 7
    (external wrench by virtual work).
    """

    name = "platform_force"
    law = "τ = −J' F with F = F0 − K p: a hose or a cable that pulls at the tool."
    symbols = (
        "J (3, n): Jacobian of the tool; p (3,): its way from home, m; F0 = (Fx, Fy, Fz): force on the tool "
        "at home, N, of either sign; K = diag(kx, ky, kz): stiffness, N/m; all in the world's axes. "
        "Directions in which the tool cannot move have no column."
    )
    shown_by = "move slowly over the whole range, without a payload"
    seen = ("position",)
    in_key = ("that of a force at the tool",)
    parameters = (
        EffectParameter("Fx", "N"),
        EffectParameter("Fy", "N"),
        EffectParameter("Fz", "N"),
        EffectParameter("kx", "N/m"),
        EffectParameter("ky", "N/m"),
        EffectParameter("kz", "N/m"),
    )
    place = "robot"

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:  # noqa: ARG002 - it sits nowhere in particular
        position, jacobian = tool_motion(robot)
        constant = -jacobian.transpose(0, 2, 1)
        return robot.refined(np.concatenate((constant, -constant * position[:, None, :]), axis=2))
