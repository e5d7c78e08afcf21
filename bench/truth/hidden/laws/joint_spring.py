"""A spring at a joint, as an actuator without command."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, add_affine_actuator, rms


@dataclass(frozen=True)
class JointSpring(JointEffect):
    """k · (q - q0): a balancing spring, a cable harness.

    k: N·m/rad or N/m, at least 0.  q0: its relaxed position, rad or m.
    """

    name = "joint_spring"
    shares = (0.02, 0.4)
    law = "k (q − q0)"
    not_negative = ("k",)
    k: float
    q0: float

    def change(self, draft: Draft) -> None:
        add_affine_actuator(draft, self.name, draft.spec.joint(self.joint), (self.k * self.q0, -self.k))

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        middle = float(np.mean(j.position))
        return {"k": share * rms(j.torque) / rms(j.position - middle), "q0": middle}
