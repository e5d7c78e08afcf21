"""Cogging torque."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, Bracket, EffectParameter, JointSamples, ShapeParameter
from bench.effects.periods import PERIODS, followed_wave, next_to, strongest_periods
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class CoggingTorque(ActuatorEffect):
    """Magnets drawn to the stator's teeth, whatever the current.

    Valid for periods within the joint's travel that the motion does not sweep faster than the fit's band. Source:
    Islam, Mir and Sebastian, "Issues in reducing the cogging torque of mass-produced permanent-magnet brushless DC
    motor", IEEE Transactions on Industry Applications 40(3), 2004.
    """

    name = "cogging_torque"
    law = "τ = a cos(N q) + b sin(N q): magnets drawn to the teeth of the stator, whatever the current."
    symbols = (
        "a, b: N·m or N, of either sign; N: periods in a turn of the joint, gear included (of a slide: in a "
        "metre, and the phase is 2 pi N q), estimated from the data."
    )
    shown_by = "turn slowly, without a payload"
    seen = ("repeats",)
    in_key = ("is the same at any torque",)
    parameters = (EffectParameter("a", "{effort}"), EffectParameter("b", "{effort}"))
    by_motor = True
    shape = (PERIODS,)

    periods: float = 12.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        return followed_wave(joint, self.periods)

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:
        if not samples:
            return super().brackets(parameter, samples)
        return strongest_periods(samples, [np.ones(len(joint_samples.position)) for joint_samples in samples])

    def brackets_near(
        self, parameter: ShapeParameter, samples: Sequence[JointSamples]
    ) -> tuple[Bracket, ...]:
        return (next_to(self.periods, samples),) if samples else super().brackets_near(parameter, samples)
