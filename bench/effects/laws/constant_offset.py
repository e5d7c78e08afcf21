"""A constant torque or force."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class ConstantOffset(ActuatorEffect):
    """An amplifier's offset, or Coulomb friction that differs with the direction of motion.

    Valid while it does not drift. Source: Khalil and Dombre, "Modeling, Identification and Control of Robots",
    2002, 9.3 (asymmetric Coulomb friction).
    """

    name = "constant_offset"
    law = "τ = c: an amplifier's offset, or Coulomb friction that differs with the direction of motion."
    symbols = "c: N·m or N, of either sign."
    shown_by = "move slowly in both directions"
    seen = ("position",)
    in_key = ("a constant, or where gravity takes up a part, a bowl",)
    varies_by_run = True
    parameters = (EffectParameter("c", "{effort}"),)

    def torque(self, joint: JointSignals) -> np.ndarray:
        return np.ones((len(joint.time), 1))
