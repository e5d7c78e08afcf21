"""A spring between motor and link."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.play import apparent_inertia, motion_cutoff, own_torque, torque_behind
from bench.effects.secant import secant
from bench.effects.signals import RobotSignals
from bench.errors import BenchError

SMALLEST, LARGEST = 1e-4, 2e-2  # rad or m: deflection that the step of the difference makes


@dataclass(frozen=True)
class DriveFlexibility(Effect):
    """The link lies behind the motor, whose position was logged, by the spring's torque over its stiffness.

    tau = tau_r(q - C tau_s) - tau_r(q) with tau_s = tau_r - Ia qdd. C: compliance, one over the stiffness,
    positive, rad/(N*m) or m/N; tau_r: torque of the present rigid model at the joint, rotor included; tau_s:
    what the spring carries of it; Ia: inertia of the rotor, which does not follow the spring. CIa = C Ia: positive,
    s2, one over the square of the rotor's angular frequency on the spring. The columns are changes of the model's
    torque where the link's position, velocity and acceleration are those behind the spring, tau_s itself included;
    what lies above the band of the joint's motion is taken off, since the encoder's noise grows with its fourth
    power. Valid well below the resonance of link and spring; damping in the spring is left out. Source: Spong,
    "Modeling and control of elastic joint robots", Journal of Dynamic Systems, Measurement, and Control 109, 1987.
    """

    name = "drive_flexibility"
    parameters = (
        EffectParameter("C", "{angle}/({effort})", positive=True),
        EffectParameter("CIa", "s^2", positive=True),
    )
    depends_on_model = True

    C: float = 0.0
    CIa: float = 0.0

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        torque, acceleration = own_torque(robot, joint)
        most = apparent_inertia(torque, acceleration)
        rotor = min(max(self.CIa, 0.0) / self.C, most) if self.C > 0.0 else 0.0
        cutoff = motion_cutoff(robot, joint)
        torque = torque + self._behind_itself(robot, joint, torque, acceleration, rotor, cutoff)
        columns = []
        for value, signal in (self.C, torque), (self.CIa, -acceleration):
            size = float(np.abs(signal).max())
            if size == 0.0:
                columns.append(np.zeros((len(robot.time), len(robot.joints), 1)))
                continue

            def change(step: float, signal: np.ndarray = signal) -> np.ndarray:
                return torque_behind(robot, joint, step * signal, rotor, cutoff)

            columns.append(secant(robot, max(value, 0.0), SMALLEST / size, LARGEST / size, change))
        return np.concatenate(columns, axis=2)

    def _behind_itself(
        self,
        robot: RobotSignals,
        joint: str,
        torque: np.ndarray,
        acceleration: np.ndarray,
        rotor: float,
        cutoff: float,
    ) -> np.ndarray:
        """How much more torque (K,) the spring carries because the link is where it is, and not where the motor is.

        A deflection beyond LARGEST, or out of reach, is one that no fit will keep: it is held to LARGEST, or left out.
        """
        behind = max(self.C, 0.0) * torque - max(self.CIa, 0.0) * acceleration
        largest = float(np.abs(behind).max())
        if largest == 0.0:
            return np.zeros_like(torque)
        behind = behind * min(1.0, LARGEST / largest)
        try:
            change = torque_behind(robot, joint, behind, rotor, cutoff)
        except BenchError:  # out of reach, or singular
            return np.zeros_like(torque)
        return change[:: robot.every, list(robot.joints).index(joint)]
