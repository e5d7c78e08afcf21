"""A torque at a fixed frequency; not in the catalogue of effects."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class PeriodicDisturbance(JointEffect):
    """size · sin(2π frequency t + phase), the same in every recording: a fan, the mains, a nearby press.

    size: N·m or N.  frequency: Hz.  phase: rad, 0 if omitted.
    """

    name = "periodic_disturbance"
    law = "size sin(2π frequency t + phase)"
    positive = ("frequency",)
    in_catalogue = False
    size: float
    frequency: float
    phase: float = 0.0

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        return lambda: p["size"] * np.sin(2 * np.pi * p["frequency"] * s.clock.time + p["phase"])

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {
            "size": np.sqrt(2) * share * rms(j.torque),
            "frequency": 2.7 * rms(j.acceleration) / rms(j.velocity) / (2 * np.pi),
        }
