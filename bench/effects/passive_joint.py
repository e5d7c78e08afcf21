"""What acts in joints without a motor, seen by the motors through the loops."""

import numpy as np

from bench.effects.signals import RobotSignals


def passive_position(robot: RobotSignals, joint: str) -> np.ndarray:
    """Position (N,) of a hinge or slide of the opened tree, rad or m, zero where the MJCF has it."""
    own = robot.geometry.joints[robot.geometry.joint_index(joint)]
    return robot.tree.q[:, own.q.start] + own.offset


def passive_velocity(robot: RobotSignals, joint: str) -> np.ndarray:
    """Velocity (N,) of a hinge or slide of the opened tree, rad/s or m/s."""
    return robot.tree.v[:, robot.geometry.joints[robot.geometry.joint_index(joint)].v.start]


def seen_by_motors(robot: RobotSignals, joint: str, torque: np.ndarray) -> np.ndarray:
    """What the motors need against a torque or force (N,) in a joint, (N, n): virtual work, J_t' torque."""
    index = robot.geometry.joints[robot.geometry.joint_index(joint)].v.start
    return robot.tree.jacobian[:, index, :] * torque[:, None]
