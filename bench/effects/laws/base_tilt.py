"""A base that does not stand as the model says."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.passive_joint import passive_position, seen_by_motors
from bench.effects.signals import RobotSignals
from bench.model.geometry import Geometry, Joint

SMALLEST = 1e-3  # rad: below it the column is the derivative
LARGEST = 0.5  # rad
LEVEL = 1e-4  # rad: rounding of a drawing
NOTHING = 1e-9  # of the model's torque: a smaller derivative is rounding


@dataclass(frozen=True)
class TiltedWeight(Effect):
    """The weight in a vertical hinge on a tilted base, if only vertical slides carry it.

    On a level base its bodies' first moments have no effect: no base parameter contains them. Source: as of `BaseTilt`.
    """

    name = "base_tilt"
    law = "τ = weight_cos cos q + weight_sin sin q"
    place = "robot"
    parameters = (EffectParameter("weight_cos", "{effort}"), EffectParameter("weight_sin", "{effort}"))

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        angle = passive_position(robot, joint)
        return np.stack(
            [seen_by_motors(robot, joint, part) for part in (np.cos(angle), np.sin(angle))], axis=2
        )


@dataclass(frozen=True)
class TiltedLoad(Effect):
    """The same in a level slide that only slides carry: its mass acts together with that of its rotor."""

    name = "base_tilt"
    law = "F = weight"
    place = "robot"
    parameters = (EffectParameter("weight", "{effort}"),)

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        return seen_by_motors(robot, joint, np.ones(len(robot.time)))[:, :, None]


@dataclass(frozen=True)
class BaseTilt(Effect):
    """The base turned about its y axis by tilt_y, then about the x axis of the floor by tilt_x.

    Valid for a robot whose masses the model knows. Weights without gravity torque in the model, on a vertical joint of
    the base, are estimated with it, see `TiltedWeight`. Source: Khalil and Dombre, "Modeling, Identification and
    Control of Robots", 2002, chapter 9 (gravity in the base frame).
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
    in_single_joints = (TiltedWeight(), TiltedLoad())
    depends_on_model = True
    changes_machine = True

    tilt_x: float = 0.0
    tilt_y: float = 0.0

    def in_joints_of(self, geometry: Geometry) -> Mapping[str, Effect]:
        """The weight in joints in which gravity does not act if the base is level."""
        weight, load = self.in_single_joints
        return {
            joint.name: weight if joint.kind == "hinge" else load
            for joint in geometry.joints
            if _level(geometry, joint)
        }

    def furthest(self, geometry: Geometry, joint: str) -> float:  # noqa: ARG002 - the same for all
        return LARGEST

    def machine(self, geometry: Geometry, joint: str, values: np.ndarray) -> Geometry:  # noqa: ARG002 - as below
        gravity = geometry.gravity
        vertical = int(np.argmax(np.abs(gravity)))
        for axis, angle in zip(((vertical + 1) % 3, (vertical + 2) % 3), values.tolist(), strict=True):
            gravity = _turned(gravity, axis, -angle)
        return replace(geometry, gravity=gravity)

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:  # noqa: ARG002 - it sits nowhere in particular
        gravity = turned = robot.geometry.gravity
        vertical = int(np.argmax(np.abs(gravity)))
        columns = []
        for axis, given in ((vertical + 1) % 3, self.tilt_x), ((vertical + 2) % 3, self.tilt_y):
            angle = float(np.clip(given, -LARGEST, LARGEST))
            column = robot.torque_change(gravity=gravity - np.cross(np.eye(3)[axis], turned))
            after = _turned(turned, axis, -angle)
            if np.abs(column).max() <= NOTHING * np.abs(robot.coarse.torque).max():
                column = np.zeros_like(column)  # the turn scales gravity to second order only
            elif abs(angle) > SMALLEST:
                column = robot.torque_change(gravity=gravity + after - turned) / angle
            columns.append(column)
            turned = after
        return np.stack(columns, axis=2)


def _level(geometry: Geometry, joint: Joint) -> bool:
    """Whether it carries a body and is a vertical hinge on vertical slides only, or a level slide on slides only."""
    size = float(np.linalg.norm(geometry.gravity))
    if joint.kind not in ("hinge", "slide") or joint.body is None or not size:
        return False
    chain = [joint]
    while chain[0].parent >= 0:
        chain.insert(0, geometry.joints[chain[0].parent])
    if any(each.kind != "slide" for each in chain[:-1]):
        return False
    turn, upright = np.eye(3), []
    for each in chain:
        turn = turn @ each.placement.rotation
        upright.append(abs(float((turn @ each.axis) @ geometry.gravity)) / size)
    if joint.kind == "slide":
        return upright[-1] < LEVEL
    return bool(min(upright) > np.cos(LEVEL))


def _turned(vector: np.ndarray, axis: int, angle: float) -> np.ndarray:
    along = np.eye(3)[axis]
    part = vector[axis] * along
    return part + np.cos(angle) * (vector - part) + np.sin(angle) * np.cross(along, vector)
