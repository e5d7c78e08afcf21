"""One joint of one recording at the fit's rate, with what the present model leaves unexplained."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class JointSamples:
    """What a search for shape parameters may look at, each (M,), decimated.

    position, velocity: rad or m and rate; motor_torque: gain times current, N*m or N; error: torque that the
    model lacks, zero where the joint does not move. duration s, of the recording; speed: the joint's RMS over
    all fitted recordings; travel: between its extreme positions in all of them; band Hz; rotates: a hinge.
    """

    position: np.ndarray
    velocity: np.ndarray
    motor_torque: np.ndarray
    error: np.ndarray
    duration: float
    speed: float
    travel: float
    band: float
    rotates: bool
