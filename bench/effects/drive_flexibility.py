"""A spring between motor and link."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Bracket, Effect, EffectParameter, ShapeParameter
from bench.effects.on_spring import deflection
from bench.effects.play import apparent_inertia, motion_cutoff, own_torque, torque_behind
from bench.effects.samples import JointSamples
from bench.effects.secant import secant
from bench.effects.signals import RobotSignals

SMALLEST, LARGEST = 1e-4, 2e-2  # rad or m: deflection that the step of the difference makes
MOST_DAMPED = 0.9  # more does not swing
LEAST = 1e-6  # of the largest squared period: one that is always above zero


@dataclass(frozen=True)
class DriveFlexibility(Effect):
    """The link lies behind the motor, whose position was logged, by the deflection d of a spring.

    tau = tau_r(q - d) - tau_r(q) with d + 2 zeta T d' + T2 d'' = C tau_s, tau_s = tau_r - Ia qdd, T T = T2 =
    C (M - Ia): the link swings on the spring. C: compliance, one over the stiffness, positive, rad/(N*m) or m/N;
    tau_r: torque of the present rigid model at the joint, rotor included, and M its inertia there; tau_s: what a
    stiff drive would carry of it; Ia: inertia of the rotor, which does not follow the spring. CIa = C Ia: positive,
    s2, one over the square of the rotor's angular frequency on the spring. zeta: damping ratio of the link on the
    spring, found from the data; without a C the link does not swing. The columns are changes of the model's torque
    where the link's position, velocity and acceleration are those behind the spring; what lies above the band of the
    joint's motion is taken off, since the encoder's noise grows with its fourth power. Valid where the
    friction is the motor's and the gear's, and no load of the spring; drives that swing together count as alone.
    Source: Spong,
    "Modeling and control of elastic joint robots", Journal of Dynamic Systems, Measurement, and Control 109, 1987.
    """

    name = "drive_flexibility"
    parameters = (
        EffectParameter("C", "{angle}/({effort})", positive=True),
        EffectParameter("CIa", "s^2", positive=True),
    )
    shape = (ShapeParameter("zeta", "1", (0.02, 0.06, 0.2, 0.6)),)
    depends_on_model = True

    C: float = 0.0
    CIa: float = 0.0
    zeta: float = 0.06

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        torque, acceleration = own_torque(robot, joint)
        most = apparent_inertia(torque, acceleration)
        rotor = min(max(self.CIa, 0.0) / self.C, most) if self.C > 0.0 else 0.0
        cutoff = motion_cutoff(robot, joint)
        parts = np.stack((torque, -acceleration), axis=1)
        if self.C > 0.0:
            squared = self.C * (_inertia(robot, joint) - rotor)
            squared = np.maximum(squared, LEAST * np.abs(squared).max())
            parts = deflection(parts, robot.coarse.interval, squared, min(max(self.zeta, 0.0), MOST_DAMPED))
        columns = []
        for value, signal in (self.C, parts[:, 0]), (self.CIa, parts[:, 1]):
            size = float(np.abs(signal).max())
            if size == 0.0:
                columns.append(np.zeros((len(robot.time), len(robot.joints), 1)))
                continue

            def change(step: float, signal: np.ndarray = signal) -> np.ndarray:
                return torque_behind(robot, joint, step * signal, rotor, cutoff)

            columns.append(secant(robot, max(value, 0.0), SMALLEST / size, LARGEST / size, change))
        return np.concatenate(columns, axis=2)

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:
        """The damping ratio is not searched where nothing swings."""
        if self.C > 0.0:
            return super().brackets(parameter, samples)
        return ((self.zeta, self.zeta, self.zeta),)


def _inertia(robot: RobotSignals, joint: str) -> np.ndarray:
    """Inertia (K,) of the present model at a joint, the other motors held, at the coarse samples."""
    at = list(robot.joints).index(joint)
    shift = np.zeros((3, *robot.coarse.position.shape))
    shift[2, :, at] = 1.0
    return robot.torque_change(shift)[:: robot.every, at]
