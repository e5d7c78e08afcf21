"""Viscous friction, as damping of the joint."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, add_damping, rms


@dataclass(frozen=True)
class ViscousFriction(JointEffect):
    """Fv · q̇, with the velocity before the step: damping is integrated explicitly.

    Fv: N·m·s/rad or N·s/m, at least 0.
    """

    name = "viscous_friction"
    law = "Fv q̇"
    not_negative = ("Fv",)
    Fv: float

    def change(self, draft: Draft) -> None:
        add_damping(draft, self.joint, self.Fv)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"Fv": share * rms(j.torque) / rms(j.velocity)}
