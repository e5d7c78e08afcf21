"""Motors and links that do not move together: the torque that the difference of their positions makes."""

import numpy as np
from scipy.signal import periodogram

from bench.effects.signals import OVERSAMPLING, WIDER, RobotSignals
from bench.signals.differentiation import central_difference
from bench.signals.filtering import low_pass

ORDER = 4  # of the low-pass and, twice that, of the differences
HELD = 0.9999  # of the acceleration's power inside the fit's band
MARGIN = 4.0
SHORTEST = 40  # coarse samples that filter and differences need


def own_torque(robot: RobotSignals, joint: str) -> tuple[np.ndarray, np.ndarray]:
    """At the coarse samples: the present rigid model's torque at a joint, and the joint's acceleration, (K,)."""
    at = list(robot.joints).index(joint)
    return robot.coarse.torque[:, at], robot.coarse.acceleration[:, at]


def apparent_inertia(torque: np.ndarray, acceleration: np.ndarray) -> float:
    """How much torque (K,) goes along with acceleration (K,): the slope of a line through both, not negative."""
    square = float(acceleration @ acceleration)
    return max(float((torque - torque.mean()) @ acceleration) / square, 0.0) if square > 0.0 else 0.0


def motion_cutoff(robot: RobotSignals, joint: str) -> float:
    """Hz: a frequency above which a joint's motion holds nothing but noise, at most twice the fit's band.

    MARGIN times that below which all but a ten-thousandth of the acceleration's power lies, inside the band.
    """
    coarse = robot.coarse
    band = robot.joints[joint].band
    acceleration = coarse.acceleration[:, list(robot.joints).index(joint)]
    frequency, power = periodogram(acceleration, 1.0 / coarse.interval, window="hann")
    inside = frequency <= band
    held = np.cumsum(power[inside])
    if not held[-1] > 0.0:
        return WIDER * band
    highest = frequency[inside][np.searchsorted(held, HELD * held[-1])]
    return float(min(MARGIN * highest, WIDER * band))


def torque_behind(
    robot: RobotSignals, joint: str, behind: np.ndarray, rotor: float = 0.0, cutoff: float | None = None
) -> np.ndarray:
    """Change of the torque (N, n) where the link of a joint lies `behind` (K,) its motor, rad or m.

    At the coarse samples; what lies above the cutoff (Hz; twice the fit's band if left out) is taken off before it
    is differentiated. rotor: the part of the model's inertia at the joint, kg*m2 or kg, that stays with the motor.
    """
    coarse = robot.coarse
    position = behind
    if robot.every > 1 and len(behind) >= SHORTEST:
        highest = WIDER / OVERSAMPLING / coarse.interval if cutoff is None else cutoff
        position = low_pass(behind, 1.0 / coarse.interval, highest, ORDER)
    velocity = central_difference(position, coarse.interval, 2 * ORDER)
    acceleration = central_difference(velocity, coarse.interval, 2 * ORDER)
    shift = np.zeros((3, *coarse.position.shape))
    at = list(robot.joints).index(joint)
    shift[:, :, at] = -np.stack((position, velocity, acceleration))
    change = robot.torque_change(shift)
    if rotor:
        change[:, at] += rotor * robot.refined(acceleration)
    return change
