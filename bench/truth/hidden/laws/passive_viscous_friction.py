"""Viscous friction in a joint without a motor."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, add_damping


@dataclass(frozen=True)
class PassiveViscousFriction(JointEffect):
    """Fv · q̇ in a passive joint, of a ball joint its angular velocity; the motors feel it through the loops.

    Fv: N·m·s/rad or N·s/m, at least 0. Balls that close a loop are no joints of the machine: none there.
    """

    name = "passive_viscous_friction"
    law = "Fv q̇ in a joint without a motor, balls included"
    scaled = ("Fv", 0.01)
    not_negative = ("Fv",)
    where = "passive"
    in_balls = True
    Fv: float

    def change(self, draft: Draft) -> None:
        add_damping(draft, self.joint, self.Fv)
