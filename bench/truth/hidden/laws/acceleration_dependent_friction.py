"""Dry friction that grows with the acceleration; not in the catalogue of effects."""

from dataclasses import dataclass

import numpy as np

from bench.basics.errors import BenchError
from bench.truth.hidden.base import Draft, DryFriction, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class AccelerationDependentFriction(DryFriction):
    """c · |q̈| · sign(q̇), and sticking at standstill; q̈ one step ago.

    c: kg·m² or kg, at least 0, and at most half of the effective inertia at the joint at home: with more, the
    friction would feed back on itself through the acceleration.
    """

    name = "acceleration_dependent_friction"
    law = "c |q̈| sign(q̇)"
    not_negative = ("c",)
    in_catalogue = False
    c: float

    def change(self, draft: Draft) -> None:
        most = 0.5 * draft.inertia[self.joint]
        if self.c > most:
            raise BenchError(f"{self.name} of joint {self.joint}: c = {self.c:g} is more than {most:.3g}")
        super().change(draft)

    @staticmethod
    def dry_friction(p: Parameters, s: Signals) -> Law:
        return lambda: p["c"] * np.abs(s.acceleration)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        c = share * rms(j.torque) / rms(j.acceleration)
        if c > 0.5 * j.inertia:
            raise j.too_large("acceleration_dependent_friction", share, "it would outweigh the inertia")
        return {"c": c}
