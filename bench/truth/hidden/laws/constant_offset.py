"""A constant torque, as an actuator that nobody commands."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, add_affine_actuator, rms


@dataclass(frozen=True)
class ConstantOffset(JointEffect):
    """c: an amplifier's offset, or the part of Coulomb friction that has a direction.

    c: N·m or N, either sign; what the motor has to supply, so that -c acts on the joint.
    """

    name = "constant_offset"
    shares = (0.01, 0.3)
    law = "c"
    c: float

    def change(self, draft: Draft) -> None:
        add_affine_actuator(draft, self.name, draft.motor_side(self.joint), (-self.c, 0.0))

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"c": share * rms(j.torque)}
