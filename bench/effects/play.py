"""Motors and links that do not move together: the torque that the difference of their positions makes."""

import numpy as np

from bench.effects.signals import OVERSAMPLING, WIDER, RobotSignals
from bench.signals.differentiation import central_difference
from bench.signals.filtering import low_pass

ORDER = 4  # of the low-pass and, twice that, of the differences
SHORTEST = 40  # coarse samples that filter and differences need


def torque_behind(robot: RobotSignals, joint: str, behind: np.ndarray) -> np.ndarray:
    """Change of the torque (N, n) where the link of a joint lies `behind` (K,) its motor, rad or m.

    At the coarse samples; what lies above twice the fit's band is taken off before it is differentiated.
    """
    coarse = robot.coarse
    position = behind
    if robot.every > 1 and len(behind) >= SHORTEST:
        position = low_pass(behind, 1.0 / coarse.interval, WIDER / OVERSAMPLING / coarse.interval, ORDER)
    velocity = central_difference(position, coarse.interval, 2 * ORDER)
    acceleration = central_difference(velocity, coarse.interval, 2 * ORDER)
    shift = np.zeros((3, *coarse.position.shape))
    shift[:, :, list(robot.joints).index(joint)] = -np.stack((position, velocity, acceleration))
    return robot.torque_change(shift)
