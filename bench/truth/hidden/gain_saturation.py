"""A drive gain that falls as the current rises."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bench.truth.hidden.base import JointEffect
from bench.truth.hidden.signals import Law, Parameters, Signals


@dataclass(frozen=True)
class GainSaturation(JointEffect):
    """τ = g i (1 - k i²): iron that saturates.

    Valid for |i| < 1 / √(3 k), where the torque still rises with the current; a controller that goes farther
    loses the robot.

    k: 1 / (drive unit)², at least 0.
    """

    name: ClassVar[str] = "gain_saturation"
    not_negative: ClassVar[tuple[str, ...]] = ("k",)
    k: float

    @staticmethod
    def gain(p: Parameters, s: Signals) -> Law:
        return lambda: 1.0 - p["k"] * s.current**2
