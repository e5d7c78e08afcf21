"""Effects in joints without a motor, which load motors through the loops."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect
from bench.effects.signals import RobotSignals
from bench.model.body_rates import JointRates, joint_rates
from bench.model.geometry import Geometry
from bench.model.motion import Motion


def passive_position(robot: RobotSignals, joint: str) -> np.ndarray:
    """Position (N,) of a hinge or slide of the opened tree, rad or m, zero where the MJCF has it."""
    return _position(robot.geometry, robot.tree, joint)


def passive_velocity(robot: RobotSignals, joint: str) -> np.ndarray:
    """Velocity (N,) of a hinge or slide of the opened tree, rad/s or m/s."""
    return robot.tree.v[:, robot.geometry.joints[robot.geometry.joint_index(joint)].v.start]


def seen_by_motors(robot: RobotSignals, joint: str, torque: np.ndarray) -> np.ndarray:
    """Motor torques (N, n) against a torque or force (N,) in a hinge or slide: virtual work, J_t' torque."""
    index = robot.geometry.joints[robot.geometry.joint_index(joint)].v.start
    return robot.tree.jacobian[:, index, :] * torque[:, None]


@dataclass(frozen=True)
class PassiveEffect(Effect):
    """An effect in a joint without a motor, a function of its position, velocity and acceleration."""

    place = "passive"

    @abstractmethod
    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Torque or force (N, d, p) in the joint for a unit value of each parameter.

        position (N, 1): rad or m, zero where the MJCF has it; not meaningful in a ball joint. velocity, acceleration
        (N, d): d is 1 in a hinge or slide, 3 in a ball joint, see `joint_rates`.
        """

    def in_joint(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """`torque` (N, d, p)."""
        return self.with_rates(robot.geometry, robot.tree, joint)[1]

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Columns (N, n, p): motor torques against `torque`, by virtual work."""
        rates, torque = self.with_rates(robot.geometry, robot.tree, joint)
        return np.einsum("kdn,kdp->knp", rates.jacobian, torque)

    def with_rates(self, geometry: Geometry, motion: Motion, joint: str) -> tuple[JointRates, np.ndarray]:
        """The rates of its joint in a motion of the opened tree, and `torque` (N, d, p)."""
        rates = joint_rates(geometry, motion, geometry.joint_index(joint))
        position = _position(geometry, motion, joint)[:, None]
        return rates, self.torque(position, rates.velocity, rates.acceleration)


def _position(geometry: Geometry, motion: Motion, joint: str) -> np.ndarray:
    spec = geometry.joints[geometry.joint_index(joint)]
    return np.asarray(motion.q[:, spec.q.start] + spec.offset)
