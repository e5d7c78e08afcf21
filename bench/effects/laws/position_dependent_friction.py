"""Dry friction that depends on the position."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, Bracket, EffectParameter, JointSamples, ShapeParameter
from bench.effects.periods import wave
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class PositionDependentFriction(ActuatorEffect):
    """Dry friction that varies over the turn, as with a bent shaft.

    Valid while the joint slides. Source: Armstrong-Helouvry, "Control of Machines with Friction", 1991; Popovic and
    Goldenberg, "Modeling of friction using spectral analysis", IEEE Transactions on Robotics and Automation 14(1),
    1998.
    """

    name = "position_dependent_friction"
    law = (
        "τ = (a cos(h q) + b sin(h q)) sign(q̇): dry friction that varies around the turn, as of a bent shaft."
    )
    symbols = (
        "a, b: N·m or N, of either sign, added to the Coulomb friction, which is an effect of its own; h: "
        "harmonic, a whole number of periods in a turn, estimated from the data (a slide: periods in a metre, "
        "whole halves of the travel, and the angle is 2 pi h q)."
    )
    shown_by = "move slowly over the whole range"
    seen = ("opposes",)
    in_key = ("varies over the position, forwards and backwards as mirror images",)
    parameters = (EffectParameter("a", "{effort}"), EffectParameter("b", "{effort}"))
    by_motor = True
    shape = (ShapeParameter("harmonic", "1/{turn}", (1.0, 2.0, 3.0, 4.0, 6.0, 8.0), discrete=True),)
    every_sample = True

    harmonic: float = 1.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        return np.sign(joint.velocity)[:, None] * wave(joint.position, self.harmonic, joint.rotates)

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:
        if not samples or samples[0].rotates:
            return super().brackets(parameter, samples)
        half = 0.5 / samples[0].travel
        return tuple((half * value, half * value, half * value) for value in parameter.candidates)
