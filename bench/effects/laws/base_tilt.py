"""A base that does not stand as the model says."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.signals import RobotSignals

SMALLEST = 1e-3  # rad: below it the column is the derivative
LARGEST = 0.5  # rad
NOTHING = 1e-9  # of the model's torque: a smaller derivative is rounding


@dataclass(frozen=True)
class BaseTilt(Effect):
    """The base turned about its y axis by tilt_y, then about the x axis of the floor by tilt_x.

    Valid for a robot whose masses the model knows: what gravity never moved in the model is not in it. Source:
    Khalil and Dombre, "Modeling, Identification and Control of Robots", 2002, chapter 9 (gravity in the base
    frame).
    """

    name = "base_tilt"
    law = "The base turned about its y axis by tilt_y, then about the x axis of the floor by tilt_x."
    symbols = (
        "Gravity in the base is then g' = Ry(−tilt_y) Rx(−tilt_x) g, and τ = τ(g') − τ(g) in the present "
        "model. tilt_x, tilt_y: rad, of either sign; where gravity points along another axis than z, the "
        "two axes are those that follow it in the order x y z."
    )
    shown_by = "move slowly over the whole range"
    seen = ("position",)
    in_key = ("that of a part of the weight, at all motors",)
    parameters = (EffectParameter("tilt_x", "rad"), EffectParameter("tilt_y", "rad"))
    place = "robot"
    depends_on_model = True

    tilt_x: float = 0.0
    tilt_y: float = 0.0

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:  # noqa: ARG002 - it sits nowhere in particular
        gravity = turned = robot.geometry.gravity
        vertical = int(np.argmax(np.abs(gravity)))
        columns = []
        for axis, given in ((vertical + 1) % 3, self.tilt_x), ((vertical + 2) % 3, self.tilt_y):
            angle = float(np.clip(given, -LARGEST, LARGEST))
            column = robot.torque_change(gravity=gravity - np.cross(np.eye(3)[axis], turned))
            after = _turned(turned, axis, -angle)
            if np.abs(column).max() <= NOTHING * np.abs(robot.coarse.torque).max():
                column = np.zeros_like(column)  # the turn only scales gravity, in second order
            elif abs(angle) > SMALLEST:
                column = robot.torque_change(gravity=gravity + after - turned) / angle
            columns.append(column)
            turned = after
        return np.stack(columns, axis=2)


def _turned(vector: np.ndarray, axis: int, angle: float) -> np.ndarray:
    along = np.eye(3)[axis]
    part = vector[axis] * along
    return part + np.cos(angle) * (vector - part) + np.sin(angle) * np.cross(along, vector)
