"""An eccentric encoder or gear: the measured position oscillates about the true one."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, Law, Parameters, Signals, harmonic


@dataclass(frozen=True)
class TransmissionError(JointEffect):
    """The measured position is q + a · cos(2π q / period) + b · sin(2π q / period), in the log and in the controller.

    a, b: rad or m.  period: rad or m; 2π for one period per turn.
    """

    name = "transmission_error"
    law = "logged and controlled position = q + a cos(2πq / period) + b sin(2πq / period)"
    positive = ("period",)
    a: float
    b: float
    period: float

    @staticmethod
    def encoder(p: Parameters, s: Signals) -> Law:
        wave_number = 2 * np.pi / p["period"]
        return lambda: harmonic(p, s.position, wave_number)
