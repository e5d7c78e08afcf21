"""A spring in a joint without a motor, as an actuator that nobody commands."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect, add_affine_actuator


@dataclass(frozen=True)
class PassiveSpring(JointEffect):
    """k · (q - q0) in a passive joint, in addition to a spring of the MJCF; the motors feel it through the loops.

    k: N·m/rad or N/m, at least 0.  q0: where it is relaxed, rad or m. Balls that close a loop are no joints of the
    machine: none there.
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
