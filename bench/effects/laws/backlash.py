"""Play between motor and link."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.interpolation import cubic_spline
from bench.effects.effect import Bracket, Effect, EffectParameter, JointSamples, ShapeParameter
from bench.effects.likely_play import likely_play
from bench.effects.motor_link_difference import ORDER, rates_behind, slopes
from bench.effects.play import Flight, Load
from bench.effects.secant import secant
from bench.effects.signals import OVERSAMPLING, WIDER, RobotSignals
from bench.signals.filtering import low_pass

SMALLEST, LARGEST = 1e-6, 0.1  # rad or m: play for which the way is computed
FINER = 4  # samples for each coarse one: an impact falls between two
REACH = 3.0  # factor by which rotor and drag may move from their values in local steps


@dataclass(frozen=True)
class Backlash(Effect):
    """The link lies on a flank of the play b until its load changes sign, then crosses the gap and stays on the other.

    The column is the change of the model's torque when the link lags the motor, whose position was logged, by that way;
    an impact is a jump of its velocity. Valid for stiff teeth that do not rebound, since the rotor gives way in the
    logged motion; a compliance of the flanks is `drive_flexibility`. Under a load that never changes its sign, it is an
    encoder offset, and rotor and drag have no effect. Source: Nordin and Gutman, "Controlling mechanical systems with
    backlash: a survey", Automatica 38(10), 2002.
    """

    name = "backlash"
    law = (
        "The link lies behind the motor, whose position was logged, by d: ± b/2 in contact, and (M − Ia) d'' + c d' "
        "= τ_s through the gap."
    )
    symbols = (
        "b: play from flank to flank, positive, rad or m; τ_s = τ_r − Ia q̈: torque that goes through the flanks, "
        "with τ_r that of the present rigid model; contact ends where τ_s changes its sign, and begins without a "
        "rebound at d = ± b/2; M: inertia of the present model at the joint; Ia: inertia of the rotor, which does "
        "not cross the gap, kg·m² or kg; c: drag in the gap, N·m·s/rad or N·s/m. Ia and c are estimated from the "
        "data."
    )
    shown_by = "go where the motor's torque changes its sign"
    seen = ("acceleration",)
    in_key = ("is short impacts where the torque of the motor changes its sign",)
    parameters = (EffectParameter("b", "{angle}", positive=True),)
    shape = (
        ShapeParameter("Ia", "{effort}*s^2/{angle}", (0.0, 1.0)),
        ShapeParameter("c", "{effort}*s/{angle}", (0.0, 1.0)),
    )
    depends_on_model = True
    every_sample = True
    bends = True

    b: float = 0.0
    Ia: float = 0.0
    c: float = 0.0

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        at = list(robot.joints).index(joint)
        by_motion, load = slopes(robot, joint), Load.of(robot, joint)
        if not load.mean > 0.0:
            return np.zeros((len(robot.time), len(robot.joints), 1))
        rotor = min(max(self.Ia, 0.0), load.mean)
        flight = Flight.under(_finer(load), rotor, self.c)
        cutoff = WIDER / OVERSAMPLING / load.interval

        def change(play: float) -> np.ndarray:
            lag = np.sign(play) * flight.lag(abs(play))
            if robot.every > 1:
                lag = low_pass(lag, 1.0 / flight.interval, cutoff, ORDER)
            rates = rates_behind(robot, lag[::FINER])
            changed = -np.einsum("okn,ok->kn", by_motion, rates)
            changed[:, at] += rotor * rates[2]
            return robot.refined(changed)

        return secant(robot, max(self.b, 0.0), SMALLEST, LARGEST, change)

    def starts(self, robots: Sequence[RobotSignals], joint: str) -> tuple["Backlash", ...]:
        """The play that the motor's error suggests: only near the right one the impacts are where they were."""
        if self.b > 0.0:
            return (self,)
        likely = likely_play(robots, joint)
        return (replace(self, b=likely.play, Ia=likely.rotor, c=likely.drag),)

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:  # noqa: ARG002
        """No range: a search begins at `starts`."""
        value = self.shape_values()[parameter.name]
        return ((value, value, value),)

    def brackets_near(
        self,
        parameter: ShapeParameter,
        samples: Sequence[JointSamples],  # noqa: ARG002
    ) -> tuple[Bracket, ...]:
        """A range around the present value; none without drag, since the link then never crossed the gap."""
        value, reach = self.shape_values()[parameter.name], REACH if self.c > 0.0 else 1.0
        return ((value / reach, value, value * reach),)


def _finer(load: Load) -> Load:
    """The load at FINER samples for each one."""
    time = load.interval * np.arange(len(load.torque))
    interval = load.interval / FINER
    given = np.stack((load.torque, load.acceleration, load.inertia), axis=1)
    fine = cubic_spline(time, given)(interval * np.arange((len(time) - 1) * FINER + 1))
    torque, acceleration, inertia = fine.T
    return Load(torque, acceleration, inertia, interval)
