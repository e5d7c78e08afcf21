"""Inertia of the motor's rotor, as armature of its joint."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, rms


@dataclass(frozen=True)
class RotorInertia(JointEffect):
    """Ia · q̈: the rotor's inertia, reflected through the gear. The rotor is not carried by the links.

    Ia: kg·m² or kg, at least 0.
    """

    name = "rotor_inertia"
    law = "Ia q̈"
    not_negative = ("Ia",)
    Ia: float

    def change(self, draft: Draft) -> None:
        draft.motor_side(self.joint).armature += self.Ia

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"Ia": share * rms(j.torque) / rms(j.acceleration)}
