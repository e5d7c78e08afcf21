"""What acts in joints without a motor, seen by the motors through the loops."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect
from bench.effects.signals import RobotSignals


def passive_position(robot: RobotSignals, joint: str) -> np.ndarray:
    """Position (N,) of a hinge or slide of the opened tree, rad or m, zero where the MJCF has it."""
    own = robot.geometry.joints[robot.geometry.joint_index(joint)]
    return robot.tree.q[:, own.q.start] + own.offset


def passive_velocity(robot: RobotSignals, joint: str) -> np.ndarray:
    """Velocity (N,) of a hinge or slide of the opened tree, rad/s or m/s."""
    return robot.tree.v[:, robot.geometry.joints[robot.geometry.joint_index(joint)].v.start]


def passive_acceleration(robot: RobotSignals, joint: str) -> np.ndarray:
    """Acceleration (N,) of a hinge or slide of the opened tree, rad/s2 or m/s2."""
    return robot.tree.a[:, robot.geometry.joints[robot.geometry.joint_index(joint)].v.start]


def seen_by_motors(robot: RobotSignals, joint: str, torque: np.ndarray) -> np.ndarray:
    """What the motors need against a torque or force (N,) in a joint, (N, n): virtual work, J_t' torque."""
    index = robot.geometry.joints[robot.geometry.joint_index(joint)].v.start
    return robot.tree.jacobian[:, index, :] * torque[:, None]


@dataclass(frozen=True)
class PassiveEffect(Effect):
    """An effect in a joint without a motor that follows from its position, velocity and acceleration."""

    place = "passive"

    @abstractmethod
    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Torque or force (N, p) in the joint for a value of one of each parameter.

        position, velocity, acceleration: (N,) of the joint, rad or m, zero where the MJCF has it, and its rates.
        """

    def in_joint(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """`torque` (N, p)."""
        return self.torque(
            passive_position(robot, joint), passive_velocity(robot, joint), passive_acceleration(robot, joint)
        )

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Columns (N, n, p): what the motors need against `torque`."""
        torque = self.in_joint(robot, joint)
        return np.stack([seen_by_motors(robot, joint, column) for column in torque.T], axis=2)
