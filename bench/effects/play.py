"""Motors and links that do not move together: the torque that the difference of their positions makes."""

import numpy as np

from bench.effects.signals import OVERSAMPLING, WIDER, RobotSignals
from bench.signals.differentiation import central_difference
from bench.signals.filtering import low_pass

ORDER = 4  # of the low-pass and, twice that, of the differences
SHORTEST = 40  # coarse samples that filter and differences need


def own_torque(robot: RobotSignals, joint: str) -> tuple[np.ndarray, np.ndarray]:
    """At the coarse samples: the present rigid model's torque at a joint, and the joint's acceleration, (K,)."""
    at = list(robot.joints).index(joint)
    return robot.coarse.torque[:, at], robot.coarse.acceleration[:, at]


def apparent_inertia(torque: np.ndarray, acceleration: np.ndarray) -> float:
    """How much torque (K,) goes along with acceleration (K,): the slope of a line through both, not negative."""
    square = float(acceleration @ acceleration)
    return max(float((torque - torque.mean()) @ acceleration) / square, 0.0) if square > 0.0 else 0.0


def torque_behind(robot: RobotSignals, joint: str, behind: np.ndarray, rotor: float = 0.0) -> np.ndarray:
    """Change of the torque (N, n) where the link of a joint lies `behind` (K,) its motor, rad or m.

    At the coarse samples; what lies above twice the fit's band is taken off before it is differentiated. rotor:
    the part of the model's inertia at the joint, kg*m2 or kg, that stays with the motor.
    """
    coarse = robot.coarse
    position = behind
    if robot.every > 1 and len(behind) >= SHORTEST:
        position = low_pass(behind, 1.0 / coarse.interval, WIDER / OVERSAMPLING / coarse.interval, ORDER)
    velocity = central_difference(position, coarse.interval, 2 * ORDER)
    acceleration = central_difference(velocity, coarse.interval, 2 * ORDER)
    shift = np.zeros((3, *coarse.position.shape))
    at = list(robot.joints).index(joint)
    shift[:, :, at] = -np.stack((position, velocity, acceleration))
    change = robot.torque_change(shift)
    if rotor:
        change[:, at] += rotor * robot.refined(acceleration)
    return change
