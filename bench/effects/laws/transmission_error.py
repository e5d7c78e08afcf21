"""A position error that repeats with the turn."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.effects.effect import Bracket, Effect, EffectParameter, JointSamples, ShapeParameter
from bench.effects.motor_link_difference import slopes
from bench.effects.periods import PERIODS, next_to, phase, strongest_periods, wave
from bench.effects.signals import WIDER, RobotSignals

ORDER = 8  # of the roll-off of waves above the fit's band
STEEPEST = 0.5  # slope of the error over the position: a steeper one is not small, and not followed
STEPS = 6  # from the logged position towards the true one, each at most STEEPEST of the one before


@dataclass(frozen=True)
class TransmissionError(Effect):
    """A joint whose position differs from the logged one by a wave of its position.

    The columns are changes of the present model's torque in proportion to the error e and its rates e' ṗ and e' p̈ +
    e'' ṗ², so fast motion reveals short waves. Valid for errors that are small compared with a period, and for periods
    within the joint's travel that the motion does not sweep faster than the fit's band. Source: Hanselman, "Resolver
    signal requirements for high accuracy resolver-to-digital conversion", IEEE Transactions on Industrial Electronics
    37(6), 1990; Tuttle and Seering, "A nonlinear model of a harmonic drive gear transmission", IEEE Transactions on
    Robotics and Automation 12(3), 1996.
    """

    name = "transmission_error"
    law = "τ = τ(p) − τ(q), q = p + a cos(N p) + b sin(N p): a joint at p where q was logged, loops closed."
    symbols = (
        "a, b: rad or m, of either sign; N: periods in a turn of what the encoder measures (of a slide: in a metre, "
        "and the phase is 2 pi N p), estimated from the data: once a turn for a disc or gear off its centre, once a "
        "tooth for teeth."
    )
    shown_by = "move fast over the whole range"
    seen = ("repeats",)
    in_key = ("grows with the speed",)
    parameters = (EffectParameter("a", "{angle}"), EffectParameter("b", "{angle}"))
    shape = (replace(PERIODS, candidates=(1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)),)
    depends_on_model = True

    a: float = 0.0
    b: float = 0.0
    periods: float = 1.0

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        coarse, motor = robot.coarse, robot.joints[joint]
        at = list(robot.joints).index(joint)
        velocity, acceleration = coarse.velocity[:, at, None], coarse.acceleration[:, at, None]
        # rad of the wave for each rad or m of the joint
        steepness = float(phase(np.ones(1), self.periods, motor.rotates)[0])
        about = self._about(steepness)
        position = logged = coarse.position[:, at]
        for _ in range(STEPS if about.any() else 0):
            position = logged - wave(position, self.periods, motor.rotates) @ about
        error = wave(position, self.periods, motor.rotates)
        slope = steepness * np.column_stack((-error[:, 1], error[:, 0]))
        bend = -(steepness**2) * error
        grown = 1.0 + (slope @ about)[:, None]
        velocity = velocity / grown
        acceleration = (acceleration - (bend @ about)[:, None] * velocity**2) / grown
        highest = 2.0 * np.pi * WIDER * motor.band
        shown = 1.0 / (1.0 + (steepness * velocity / highest) ** ORDER)
        rates = shown * np.stack((error, slope * velocity, slope * acceleration + bend * velocity**2))
        return robot.refined(-np.einsum("okn,okp->knp", slopes(robot, joint), rates))

    def _about(self, steepness: float) -> np.ndarray:
        """a and b (2,) about which it is linearised, limited to small values relative to a period."""
        about = np.array([self.a, self.b])
        steep = steepness * float(np.hypot(*about))
        return about * (STEEPEST / steep) if steep > STEEPEST else about

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:
        if not samples:
            return super().brackets(parameter, samples)
        pace = max(samples[0].speed, np.finfo(float).tiny)
        return strongest_periods(
            samples, [1.0 + (joint_samples.velocity / pace) ** 2 for joint_samples in samples]
        )

    def brackets_near(
        self, parameter: ShapeParameter, samples: Sequence[JointSamples]
    ) -> tuple[Bracket, ...]:
        return (next_to(self.periods, samples),) if samples else super().brackets_near(parameter, samples)
