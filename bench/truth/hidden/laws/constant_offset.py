"""A constant torque, as an actuator without command."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, add_affine_actuator, rms


@dataclass(frozen=True)
class ConstantOffset(JointEffect):
    """c: an amplifier's offset, or the asymmetric part of Coulomb friction.

    c: N·m or N, either sign; the motor has to supply it, so -c acts on the joint.
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
