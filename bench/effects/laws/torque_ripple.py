"""Torque ripple."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, Bracket, EffectParameter, JointSamples, ShapeParameter
from bench.effects.periods import PERIODS, followed_wave, next_to, strongest_periods
from bench.effects.signals import JointSignals

LEAST = 0.2  # of the gain, that remains at the largest ripple


@dataclass(frozen=True)
class TorqueRipple(ActuatorEffect):
    """A drive gain that varies with the position of the motor.

    The columns are the missing torque, -g i cos(N q) and -g i sin(N q). Valid for ripple well below one, at periods
    that the motion does not sweep faster than the fit's band. Source: Jahns and Soong, "Pulsating torque minimization
    techniques for permanent magnet AC motor drives: a review", IEEE Transactions on Industrial Electronics 43(2), 1996.
    """

    name = "torque_ripple"
    law = "τ = g i (1 + a cos(N q) + b sin(N q)): a drive gain that varies with the position of the motor."
    symbols = (
        "a, b: dimensionless, of either sign; N: periods in a turn of the joint, gear included (of a slide: "
        "in a metre, and the phase is 2 pi N q), estimated from the data; g i: drive gain times the current "
        "that the torque needed by the present model takes; were it the measured one, that would be "
        "explained by itself in part."
    )
    shown_by = "turn slowly, with and without a payload"
    seen = ("repeats",)
    in_key = ("grows with the current",)
    parameters = (EffectParameter("a", "1"), EffectParameter("b", "1"))
    by_motor = True
    shape = (PERIODS,)
    depends_on_model = True
    before_torque = True
    of_instant = True

    periods: float = 12.0
    a: float = 0.0
    b: float = 0.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        waves = followed_wave(joint, self.periods)
        given = np.maximum(1.0 + waves @ np.array([self.a, self.b]), LEAST)
        return -(joint.needed_torque / given)[:, None] * waves

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:
        if not samples:
            return super().brackets(parameter, samples)
        return strongest_periods(samples, [joint_samples.motor_torque for joint_samples in samples])

    def brackets_near(
        self, parameter: ShapeParameter, samples: Sequence[JointSamples]
    ) -> tuple[Bracket, ...]:
        return (next_to(self.periods, samples),) if samples else super().brackets_near(parameter, samples)
