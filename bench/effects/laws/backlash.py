"""Play between motor and link."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter, ShapeParameter
from bench.effects.motor_link_difference import apparent_inertia, torque_behind, torque_of_motor
from bench.effects.secant import secant
from bench.effects.signals import RobotSignals

SOFT = 0.1  # of the RMS torque: below it the link is between the two flanks
SMALLEST, LARGEST = 1e-4, 2e-2  # rad or m: step of the difference


@dataclass(frozen=True)
class Backlash(Effect):
    """The link lies behind the motor, whose position was logged, by half the play b: q - b/2 tanh(tau_s / t0).

    The column is the change of the model's torque, low-passed to twice the fit's band: a blow at every change of
    the sign of tau_s, besides the shifted position. Valid for play that is small and crossed quickly; under a load
    that never changes its sign, it is an encoder offset. Source: Nordin and Gutman, "Controlling mechanical systems
    with backlash: a survey", Automatica 38(10), 2002.
    """

    name = "backlash"
    law = (
        "The link lies behind the motor, whose position was logged, by half the play b: q − b/2 tanh(τ_s / "
        "t0)."
    )
    symbols = (
        "b: play from flank to flank, positive, rad or m; τ_s = τ_r − r J q̈: torque that goes through the "
        "flanks, which says on which of them the link lies, with τ_r that of the present rigid model, J the "
        "inertia that the joint's torque shows on average, and r the rotor's share of it, one of four "
        "values, estimated from the data; t0: a tenth of the RMS of τ_s, for a change of flank in finite time."
    )
    shown_by = "go where the motor's torque changes its sign"
    seen = ("acceleration",)
    in_key = ("is short impacts where the torque of the motor changes its sign",)
    parameters = (EffectParameter("b", "{angle}", positive=True),)
    shape = (ShapeParameter("r", "1", (0.0, 0.3, 0.6, 0.9), discrete=True),)
    depends_on_model = True
    every_sample = True

    b: float = 0.0
    r: float = 0.0

    def nodes(self, robot: RobotSignals, joint: str) -> tuple[float, float] | None:  # noqa: ARG002 - everywhere
        return SMALLEST, LARGEST

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        torque, acceleration = torque_of_motor(robot, joint)
        rotor = self.r * apparent_inertia(torque, acceleration)
        carried = torque - rotor * acceleration
        soft = SOFT * float(np.sqrt((carried**2).mean()))
        if soft == 0.0:
            return np.zeros((len(robot.time), len(robot.joints), 1))
        side = 0.5 * np.tanh(carried / soft)

        def change(play: float) -> np.ndarray:
            return torque_behind(robot, joint, play * side, rotor)

        return secant(robot, max(self.b, 0.0), SMALLEST, LARGEST, change)
