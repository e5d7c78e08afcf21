"""A spring in a joint without a motor, as an actuator without command."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, add_affine_actuator


@dataclass(frozen=True)
class PassiveSpring(JointEffect):
    """k · (q - q0) in a passive joint, in addition to a spring of the MJCF; it acts on the motors through the loops.

    k: N·m/rad or N/m, at least 0. q0: its relaxed position, rad or m. Ball joints cannot have it.
    """

    name = "passive_spring"
    shares = (0.02, 0.4)
    law = "k (q − q0) in a joint without a motor"
    not_negative = ("k",)
    where = "passive"
    k: float
    q0: float

    def change(self, draft: Draft) -> None:
        add_affine_actuator(draft, self.name, draft.spec.joint(self.joint), (self.k * self.q0, -self.k))
