"""A spring between motor and link."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.play import apparent_inertia, own_torque, torque_behind
from bench.effects.secant import secant
from bench.effects.signals import RobotSignals
from bench.errors import BenchError

ROUNDS = 3
SMALLEST, LARGEST = 1e-4, 2e-2  # rad or m: deflection that the step of the difference makes


@dataclass(frozen=True)
class DriveFlexibility(Effect):
    """The link lies behind the motor, whose position was logged, by the spring's torque over its stiffness.

    tau = tau_r(q - C tau_s) - tau_r(q) with tau_s = tau_l - Ia qdd. C: compliance, one over the stiffness,
    positive, rad/(N*m) or m/N; tau_r: torque of the present rigid model at the joint, rotor included; tau_l: the
    same where the link lies behind the motor; tau_s: what the spring carries of it; Ia: inertia of the rotor,
    which does not follow the spring. CIa = C Ia: positive,
    s2, one over the square of the rotor's angular frequency on the spring. The columns are changes of the model's
    torque where the link's position, velocity and acceleration are those behind the spring. Valid well below the
    resonance of link and spring; damping in the spring is left out. Source: Spong, "Modeling and control of
    elastic joint robots", Journal of Dynamic Systems, Measurement, and Control 109, 1987.
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
        carried = self._behind(robot, joint, torque, acceleration, rotor)
        columns = []
        for value, signal in (self.C, carried), (self.CIa, -acceleration):
            size = float(np.abs(signal).max())
            if size == 0.0:
                columns.append(np.zeros((len(robot.time), len(robot.joints), 1)))
                continue

            def change(step: float, signal: np.ndarray = signal) -> np.ndarray:
                return torque_behind(robot, joint, step * signal, rotor)

            columns.append(secant(robot, max(value, 0.0), SMALLEST / size, LARGEST / size, change))
        return np.concatenate(columns, axis=2)

    def _behind(
        self, robot: RobotSignals, joint: str, torque: np.ndarray, acceleration: np.ndarray, rotor: float
    ) -> np.ndarray:
        """The torque (K,) at the joint where the link lies behind the motor by what that torque makes of it.

        Some rounds of the fixed point, which lead there below the resonance of link and spring.
        """
        if self.C <= 0.0:
            return torque
        at = list(robot.joints).index(joint)
        found = torque
        for _ in range(ROUNDS):
            behind = self.C * (found - rotor * acceleration)
            try:
                change = torque_behind(robot, joint, behind, rotor)
            except BenchError:  # out of reach, or singular
                return torque
            found = torque + change[:: robot.every, at]
        return found
