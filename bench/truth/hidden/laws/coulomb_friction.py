"""Coulomb friction, as a friction constraint of the joint."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, hard_friction, rms


@dataclass(frozen=True)
class CoulombFriction(JointEffect):
    """Fc · sign(q̇); at standstill, a holding torque of up to Fc. Exact above about 1e-3 rad/s, see
    `harden_friction`.

    Fc: N·m or N, at least 0.
    """

    name = "coulomb_friction"
    law = "Fc sign(q̇)"
    not_negative = ("Fc",)
    Fc: float

    def change(self, draft: Draft) -> None:
        draft.motor_side(self.joint).frictionloss += self.Fc
        hard_friction(draft, self.joint)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"Fc": share * rms(j.torque)}
