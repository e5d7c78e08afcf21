"""Drag that grows with the square of the speed, as damping of the joint."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, add_damping, rms


@dataclass(frozen=True)
class QuadraticDrag(JointEffect):
    """c · q̇ · |q̇|: churned oil or air.

    c: N·m·s²/rad² or N·s²/m², at least 0.
    """

    name = "quadratic_drag"
    law = "c q̇ |q̇|"
    not_negative = ("c",)
    c: float

    def change(self, draft: Draft) -> None:
        add_damping(draft, self.joint, 0.0, self.c)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"c": share * rms(j.torque) / rms(j.velocity**2)}
