"""Coulomb friction in a joint without a motor."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, hard_friction


@dataclass(frozen=True)
class PassiveCoulombFriction(JointEffect):
    """Fc · sign(q̇) in a passive joint; it acts on the motors through the loops. In a ball joint, Fc · ω / |ω|.

    Exact above about 1e-3 rad/s of the passive joint, see `harden_friction`; for ball joints, see
    `bench.truth.balls`. Fc: N·m or N, at least 0. Balls that only close a loop are not joints of the machine and
    cannot have it.
    """

    name = "passive_coulomb_friction"
    law = "Fc q̇/|q̇| in a joint without a motor, balls included"
    scaled = ("Fc", 0.01)
    not_negative = ("Fc",)
    where = "passive"
    in_balls = True
    Fc: float

    def change(self, draft: Draft) -> None:
        draft.spec.joint(self.joint).frictionloss += self.Fc
        hard_friction(draft, self.joint)
