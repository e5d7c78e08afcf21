"""What an actuated joint and its motor do in a movement, and what the sizes of its effects follow from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError

Array = NDArray[np.float64]
Sizes = dict[str, float]
"""Parameters of an effect by name."""


@dataclass(frozen=True, eq=False)
class JointMovement:
    """One actuated joint of a reference; N samples of all recordings, SI units."""

    joint: str
    slide: bool
    time: Array
    """(N,) in each recording from 0."""
    period: float
    position: Array
    velocity: Array
    acceleration: Array
    torque: Array
    """Of the motor, as its first and second derivative with time below."""
    torque_rate: Array
    torque_bend: Array
    current: Array
    current_rate: Array
    other_torques: Array
    """Sum of the torques of the other motors."""
    inertia: float
    """That the joint feels at home, loops closed."""
    armature: float
    stiffness: float
    """kp of the controller."""
    damping: float
    """kv of the controller."""

    @property
    def duration(self) -> float:
        """Of the longest recording, s."""
        return float(self.time.max())

    @property
    def span(self) -> float:
        """From the least to the greatest position."""
        return float(np.ptp(self.position))


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def wave_sizes(j: JointMovement, factor: np.ndarray, share: float) -> Sizes:
    """a, b and harmonic of a wave times a factor (N,); it falls towards the greatest position, positive all along.

    One harmonic in the position of a hinge, unless it turns so far that this would change its sign.
    """
    reach = 0.9 * np.pi
    harmonic = reach / j.span if j.slide or j.span > reach else 1.0
    phase = harmonic * j.position.max() - reach / 2
    size = share * rms(j.torque) / rms(np.cos(harmonic * j.position - phase) * factor)
    waves = {"a": size * np.cos(phase), "b": size * np.sin(phase)}
    return waves if harmonic == 1.0 else waves | {"harmonic": harmonic}


def too_large(effect: str, j: JointMovement, share: float, why: str) -> BenchError:
    """What is said where an effect cannot have such a share of the torque."""
    return BenchError(f"{effect} of joint {j.joint}: a share of {share:g} of its torque is too large: {why}")
