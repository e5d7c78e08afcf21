"""A base that does not stand as the model says."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.signals import RobotSignals


@dataclass(frozen=True)
class BaseTilt(Effect):
    """Gravity turned by small angles about the world's x and y axes: g' = g + (tilt_x e_x + tilt_y e_y) x g.

    tilt_x, tilt_y: rad, of either sign; where gravity points along another axis than z, the two axes are those
    that follow it in the order x y z. The columns are the change of the present model's torque. Valid for small
    tilts of a robot whose masses the model knows: what the model's gravity never moved is not in it. Source:
    Khalil and Dombre, "Modeling, Identification and Control of Robots", 2002, chapter 9 (gravity in the base
    frame).
    """

    name = "base_tilt"
    parameters = (EffectParameter("tilt_x", "rad"), EffectParameter("tilt_y", "rad"))
    place = "robot"
    depends_on_model = True

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:  # noqa: ARG002 - it sits nowhere in particular
        gravity = robot.geometry.gravity
        vertical = int(np.argmax(np.abs(gravity)))
        axes = np.eye(3)[[(vertical + 1) % 3, (vertical + 2) % 3]]
        changes = [robot.torque_change(gravity=gravity + np.cross(axis, gravity)) for axis in axes]
        return np.stack(changes, axis=2)
