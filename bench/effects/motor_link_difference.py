"""Motors and links that do not move together: torque due to the difference of their positions."""

import numpy as np

from bench.effects.signals import OVERSAMPLING, WIDER, RobotSignals
from bench.signals.differentiation import central_difference
from bench.signals.filtering import low_pass
from bench.signals.spectrum import hann_spectrum

ORDER = 4  # of the low-pass and, twice that, of the differences
HELD = 0.9999  # of the acceleration's power inside the fit's band
MARGIN = 4.0
SHORTEST = 40  # coarse samples that filter and differences need
TURN, SLIDE = 1e-4, 1e-5  # rad, m: shift of a joint for a derivative
SHARE = 1e-3  # of the RMS speed, likewise


def torque_of_motor(robot: RobotSignals, joint: str) -> tuple[np.ndarray, np.ndarray]:
    """At the coarse samples: the load of a joint's drive by the present model's link, and the joint's acceleration,
    (K,).
    """
    at = list(robot.joints).index(joint)
    at_link = robot.at_links()[:: robot.every, at]
    return robot.coarse.torque[:, at] + at_link, robot.coarse.acceleration[:, at]


def apparent_inertia(torque: np.ndarray, acceleration: np.ndarray) -> float:
    """Torque (K,) per acceleration (K,): the slope of a fitted line, not negative."""
    square = float(acceleration @ acceleration)
    return max(float((torque - torque.mean()) @ acceleration) / square, 0.0) if square > 0.0 else 0.0


def motion_cutoff(robot: RobotSignals, joint: str) -> float:
    """Hz: a frequency above which a joint's motion holds only noise, at most twice the fit's band.

    MARGIN times that below which all but a ten-thousandth of the acceleration's power in the band lies.
    """
    coarse, band = robot.coarse, robot.joints[joint].band
    acceleration = coarse.acceleration[:, list(robot.joints).index(joint)]
    highest = motion_band(acceleration, coarse.interval, band, HELD)
    return WIDER * band if highest == band else float(min(MARGIN * highest, WIDER * band))


def motion_band(values: np.ndarray, interval: float, band: float, share: float) -> float:
    """Hz: frequency below which this share of the power of a joint's rates (K,) inside a band lies.

    The band itself without power. interval: s, between samples.
    """
    frequency, power = hann_spectrum(values, 1.0 / interval, len(values), centred=True)
    inside = frequency <= band
    held = np.cumsum(power[inside])
    if not held[-1] > 0.0:
        return band
    return float(frequency[inside][np.searchsorted(held, share * held[-1])])


def torque_behind(
    robot: RobotSignals, joint: str, behind: np.ndarray, rotor: float = 0.0, cutoff: float | None = None
) -> np.ndarray:
    """Change of the torque (N, n) if the link of a joint lags its motor by `behind` (K,), rad or m.

    At the coarse samples; frequencies above the cutoff (Hz; default: twice the fit's band) are removed before
    differentiation. rotor: the part of the model's inertia at the joint, kg*m2 or kg, that moves with the motor.
    """
    rates = rates_behind(robot, behind, cutoff)
    shift = np.zeros((3, *robot.coarse.position.shape))
    at = list(robot.joints).index(joint)
    shift[:, :, at] = -rates
    change = robot.torque_change(shift)
    if rotor:
        change[:, at] += rotor * robot.refined(rates[2])
    return change


def rates_behind(robot: RobotSignals, behind: np.ndarray, cutoff: float | None = None) -> np.ndarray:
    """The lag of a link behind its motor (K,), low-passed at the cutoff, and its two rates: (3, K)."""
    interval = robot.coarse.interval
    position = behind
    if robot.every > 1 and len(behind) >= SHORTEST:
        highest = WIDER / OVERSAMPLING / interval if cutoff is None else cutoff
        position = low_pass(behind, 1.0 / interval, highest, ORDER)
    velocity = central_difference(position, interval, 2 * ORDER)
    return np.stack((position, velocity, central_difference(velocity, interval, 2 * ORDER)))


def slopes(robot: RobotSignals, joint: str) -> np.ndarray:
    """Derivatives (3, K, n) of the present model's torque by position, velocity and acceleration of one joint."""
    key = ("slopes", joint)
    if key not in robot.noted:
        coarse, at = robot.coarse, list(robot.joints).index(joint)
        speed = float(np.sqrt((coarse.velocity[:, at] ** 2).mean()))
        steps = (TURN if robot.joints[joint].rotates else SLIDE, SHARE * speed or SHARE, 1.0)
        derivatives = np.zeros((3, *coarse.torque.shape))
        for order, step in enumerate(steps):
            shift = np.zeros_like(derivatives)
            shift[order, :, at] = step
            derivatives[order] = robot.coarse_change(shift) / step
        robot.noted[key] = derivatives
    return robot.noted[key]
