"""What the rigid bodies ask of one motor."""

import numpy as np

from bench.effects.signals import RobotSignals


def load_at(robot: RobotSignals, joint: str) -> np.ndarray:
    """Torque or force (N,) that the present model's rigid bodies need of an actuated joint, N*m or N.

    Without any effect: what a law explains is not part of it, so that a law of the load does not explain itself.
    """
    key = ("load",)
    if key not in robot.noted:
        robot.noted[key] = robot.refined(robot.coarse.torque)
    return robot.noted[key][:, list(robot.joints).index(joint)]
