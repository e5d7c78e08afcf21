"""What acts in joints without a motor, seen by the motors through the loops."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect
from bench.effects.signals import RobotSignals


@dataclass(frozen=True)
class PassiveEffect(Effect):
    """An effect in a joint without a motor that follows from its position and velocity."""

    place = "passive"

    @abstractmethod
    def torque(self, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Torque or force (N, p) in the joint for a value of one of each parameter.

        position, velocity: (N,) of the joint, rad or m, zero where the MJCF has it, and its rate.
        """

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Columns (N, n, p): what the motors need against `torque`, by virtual work, J_p' torque."""
        own = robot.geometry.joints[robot.geometry.joint_index(joint)]
        torque = self.torque(robot.tree.q[:, own.q.start] + own.offset, robot.tree.v[:, own.v.start])
        columns: np.ndarray = robot.tree.jacobian[:, own.v.start, :, None] * torque[:, None, :]
        return columns
