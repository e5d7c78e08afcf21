"""A spring between motor and link."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.play import torque_behind
from bench.effects.secant import secant
from bench.effects.signals import RobotSignals

SMALLEST, LARGEST = 1e-4, 2e-2  # rad or m: deflection that the step of the difference makes


@dataclass(frozen=True)
class DriveFlexibility(Effect):
    """The link lies behind the motor, whose position was logged, by its torque over the stiffness: q - C tau.

    C: compliance, one over the stiffness, positive, rad/(N*m) or m/N; tau: torque of the present rigid model at
    the joint, which the spring carries. The column is the change of that model's torque where the link's position,
    velocity and acceleration are those of q - C tau. Valid well below the resonance of link and spring; the
    inertia of the rotor is not set apart. Source: Spong, "Modeling and control of elastic joint robots", Journal
    of Dynamic Systems, Measurement, and Control 109, 1987.
    """

    name = "drive_flexibility"
    parameters = (EffectParameter("C", "{angle}/({effort})", positive=True),)
    depends_on_model = True

    C: float = 0.0

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        torque = robot.coarse.torque[:, list(robot.joints).index(joint)]
        largest = float(np.abs(torque).max())
        if largest == 0.0:
            return np.zeros((len(robot.time), len(robot.joints), 1))
        least, most = SMALLEST / largest, LARGEST / largest
        return secant(robot, max(self.C, 0.0), least, most, lambda c: torque_behind(robot, joint, c * torque))
