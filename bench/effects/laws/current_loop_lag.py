"""A current loop that follows its reference with a lag."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals
from bench.signals.differentiation import central_difference


@dataclass(frozen=True)
class CurrentLoopLag(ActuatorEffect):
    """The torque follows the current reference i with a first-order lag.

    The column is dtau/dt; a column of the current itself would also fit the current's noise. Valid for one dominant
    pole. Source: Spong, Hutchinson and Vidyasagar, "Robot Modeling and Control", 2006, chapter 6 (motor dynamics).
    """

    name = "current_loop_lag"
    law = "g i = τ + T dτ/dt: the torque follows the current reference i with a first-order lag."
    symbols = "T: time constant, positive, s; τ: torque that the present model needs."
    shown_by = "reverse fast"
    seen = ("current", "velocity")
    in_key = (
        "largest where the current changes fast; over the usual motions the two are the same",
        "a line in a wide band, since it is the current's change that counts",
    )
    parameters = (EffectParameter("T", "s", positive=True),)
    by_motor = True
    depends_on_model = True
    before_torque = True
    every_sample = True

    def torque(self, joint: JointSignals) -> np.ndarray:
        return central_difference(joint.needed_torque, 1.0 / joint.rate, 2)[:, None]
