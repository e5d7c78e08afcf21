"""Force of a fluid on a tool that moves through it."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.signals import RobotSignals
from bench.effects.tool_motion import tool_motion


@dataclass(frozen=True)
class ToolDrag(Effect):
    """Drag of a blunt body at the tool, in air or a liquid.

    Valid for a fluid at rest and a body of similar width in all directions. Source: Batchelor, "An Introduction to
    Fluid Dynamics", 1967, section 5.11; carried to the motors by virtual work (Briot and Khalil, "Dynamics of Parallel
    Robots", 2015, chapter 7).
    """

    name = "tool_drag"
    law = "τ = J' c |v| v: drag of a blunt body at the tool, in air or a liquid."
    symbols = (
        "c: half of density, drag coefficient and area, positive, N·s²/m²; v (3,): velocity of the tool; J (3, n): "
        "its Jacobian by the motors' velocities."
    )
    shown_by = "move the tool fast, in all directions"
    seen = ("velocity",)
    in_key = ("bent, and its size depends on the pose, at several motors",)
    parameters = (EffectParameter("c", "N*s^2/m^2", positive=True),)
    by_motor = True
    place = "robot"

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:  # noqa: ARG002 - it sits nowhere in particular
        _, jacobian = tool_motion(robot)
        velocity = np.einsum("kxn,kn->kx", jacobian, robot.coarse.velocity)
        drag = np.linalg.norm(velocity, axis=1)[:, None] * velocity
        return robot.refined(np.einsum("kxn,kx->kn", jacobian, drag)[:, :, None])
