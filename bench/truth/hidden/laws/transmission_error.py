"""An encoder or gear that is off its centre: what is measured swings about the true position."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, Law, Parameters, Signals, harmonic


@dataclass(frozen=True)
class TransmissionError(JointEffect):
    """What is measured is q + a · cos(2π q / period) + b · sin(2π q / period): the controller acts on it, too.

    a, b: rad or m.  period: rad or m; 2π for once a turn.
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
