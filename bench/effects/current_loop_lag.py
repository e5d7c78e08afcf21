"""A current loop that follows its reference with a lag."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals
from bench.signals.differentiation import central_difference

LONGEST = 0.2  # s
SHORTEST = 1e-2  # samples: below it the column is the derivative of the current


@dataclass(frozen=True)
class CurrentLoopLag(ActuatorEffect):
    """tau = g f with T df/dt + f = i: the current f in the motor follows its reference i with a first-order lag.

    T: time constant, positive, s; g: drive gain. The column is g (i - f) / T, for T = 0 the derivative of g i. The
    filter is exact for a reference that is straight between samples. Valid for one dominant pole, T up to 0.2 s.
    Source: Spong, Hutchinson and Vidyasagar, "Robot Modeling and Control", 2006, chapter 6 (motor dynamics).
    """

    name = "current_loop_lag"
    parameters = (EffectParameter("T", "s", positive=True),)
    depends_on_model = True

    T: float = 0.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        constant = min(self.T, LONGEST)
        if constant * joint.rate < SHORTEST:
            return joint.gain * central_difference(joint.current, 1.0 / joint.rate, 2)[:, None]
        lacking = joint.current - lagged(joint.current, constant * joint.rate)
        return (joint.gain * lacking / constant)[:, None]


def lagged(values: np.ndarray, constant: float) -> np.ndarray:
    """Values (N,) behind a first-order lag of so many samples, from rest at the first of them."""
    kept = np.exp(-1.0 / constant)
    mean = constant * -np.expm1(-1.0 / constant)  # of the decay over a sample
    filtered = lfilter([1.0 - mean, mean - kept], [1.0, -kept], values - values[0])
    return np.asarray(filtered + values[0])
