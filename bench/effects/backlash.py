"""Play between motor and link."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.play import torque_behind
from bench.effects.secant import secant
from bench.effects.signals import RobotSignals

SOFT = 0.1  # of the RMS torque: within it the link is between the two flanks
SMALLEST, LARGEST = 1e-4, 2e-2  # rad or m: step of the difference


@dataclass(frozen=True)
class Backlash(Effect):
    """The link lies behind the motor, whose position was logged, by half the play b: q - b/2 tanh(tau / t0).

    b: play from flank to flank, positive, rad or m; tau: torque of the present rigid model at the joint, which
    says on which flank the link lies; t0: a tenth of its RMS, for a change of flank in finite time. The column is
    the change of the model's torque, low-passed to twice the fit's band: a blow at every change of the torque's
    sign, besides the shifted position. Valid for play that is small and crossed quickly; what the rotor does
    between the flanks is left out. Source: Nordin and Gutman, "Controlling mechanical systems with backlash: a
    survey", Automatica 38(10), 2002.
    """

    name = "backlash"
    parameters = (EffectParameter("b", "{angle}", positive=True),)
    depends_on_model = True

    b: float = 0.0

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        torque = robot.coarse.torque[:, list(robot.joints).index(joint)]
        soft = SOFT * float(np.sqrt((torque**2).mean()))
        if soft == 0.0:
            return np.zeros((len(robot.time), len(robot.joints), 1))
        side = 0.5 * np.tanh(torque / soft)
        return secant(
            robot, max(self.b, 0.0), SMALLEST, LARGEST, lambda b: torque_behind(robot, joint, b * side)
        )
