"""A joint position whose zero is wrong."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.secant import rounded, secant
from bench.effects.signals import RobotSignals
from bench.model.geometry import Geometry

SMALLEST, NEAR, LARGEST = 1e-3, 0.02, 0.5  # rad (m for a slide, a tenth of that): step of the difference
SLIDE = 0.1


@dataclass(frozen=True)
class EncoderOffset(Effect):
    """A joint that is at q - offset where q was logged: tau = tau(q - offset) - tau(q), loops closed.

    The column is a difference quotient of the present model's torque; earlier joints, in actuator order, have the
    offsets of the present model, so that columns add up to the whole. Valid for small offsets; that of the last joint
    of an open chain turns a body about its joint, which the body's parameters absorb. Source: Khalil and Dombre,
    "Modeling, Identification and Control of Robots", 2002, chapter 11 (geometric calibration).
    """

    name = "encoder_offset"
    law = "A joint at q − offset where q was logged: τ = τ(q − offset) − τ(q), loops closed."
    symbols = "offset: rad or m, of either sign, constant."
    shown_by = "move slowly over the whole range"
    seen = ("position",)
    in_key = ("small, and grows with acceleration too",)
    parameters = (EffectParameter("offset", "{angle}"),)
    depends_on_model = True
    bends = True
    changes_machine = True

    offset: float = 0.0

    def position_offset(self, values: np.ndarray) -> float:
        return float(values[0])

    def furthest(self, geometry: Geometry, joint: str) -> float:
        slides = geometry.joints[geometry.joint_index(joint)].kind == "slide"
        return LARGEST * (SLIDE if slides else 1.0)

    def nodes(self, robot: RobotSignals, joint: str) -> tuple[float, float] | None:
        size = NEAR * (1.0 if robot.joints[joint].rotates else SLIDE)
        return -size, size

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        unit = 1.0 if robot.joints[joint].rotates else SLIDE
        joints = list(robot.joints)
        index = joints.index(joint)
        before = tuple(rounded(robot.offsets.get(other, 0.0)) for other in joints[:index])

        def change(offset: float) -> np.ndarray:
            after = _torque_at(robot, (*before, offset))
            return after - _torque_at(robot, before) if any(before) else after

        return secant(robot, self.offset, SMALLEST * unit, LARGEST * unit, change)


def _torque_at(robot: RobotSignals, offsets: tuple[float, ...]) -> np.ndarray:
    """Change of the torque (N, n) if the first joints have these offsets."""
    key = ("offsets", *offsets)
    if key not in robot.noted:
        shift = np.zeros((3, *robot.coarse.position.shape))
        shift[0, :, : len(offsets)] = -np.array(offsets)
        robot.noted[key] = robot.torque_change(shift)
    return robot.noted[key]
