"""What acts in joints without a motor, seen by the motors through the loops."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect
from bench.effects.signals import RobotSignals
from bench.model.joint_rates import joint_rates


def passive_position(robot: RobotSignals, joint: str) -> np.ndarray:
    """Position (N,) of a hinge or slide of the opened tree, rad or m, zero where the MJCF has it."""
    own = robot.geometry.joints[robot.geometry.joint_index(joint)]
    return robot.tree.q[:, own.q.start] + own.offset


def passive_velocity(robot: RobotSignals, joint: str) -> np.ndarray:
    """Velocity (N,) of a hinge or slide of the opened tree, rad/s or m/s."""
    return robot.tree.v[:, robot.geometry.joints[robot.geometry.joint_index(joint)].v.start]


def seen_by_motors(robot: RobotSignals, joint: str, torque: np.ndarray) -> np.ndarray:
    """What the motors need against a torque or force in a joint, (N, n): virtual work, J_t' torque.

    torque: (N,) of a hinge or slide; (N, 3) of a ball joint, in the frame of its body.
    """
    own = robot.geometry.joints[robot.geometry.joint_index(joint)].v
    return np.einsum("kdn,kd->kn", robot.tree.jacobian[:, own], torque.reshape(len(torque), -1))


@dataclass(frozen=True)
class PassiveEffect(Effect):
    """An effect in a joint without a motor that follows from its position, velocity and acceleration."""

    place = "passive"

    @abstractmethod
    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Torque or force (N, d, p) in the joint for a value of one of each parameter.

        position (N, 1): rad or m, zero where the MJCF has it; nothing to go by in a ball joint. velocity, acceleration
        (N, d): d is 1 in a hinge or slide, 3 in a ball joint, see `joint_rates`.
        """

    def in_joint(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """`torque` (N, d, p)."""
        rates = joint_rates(robot.geometry, robot.tree, robot.geometry.joint_index(joint))
        return self.torque(passive_position(robot, joint)[:, None], *rates)

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Columns (N, n, p): what the motors need against `torque`."""
        torque = self.in_joint(robot, joint)
        return np.stack([seen_by_motors(robot, joint, column) for column in np.moveaxis(torque, 2, 0)], axis=2)
