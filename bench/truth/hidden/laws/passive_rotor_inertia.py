"""Inertia of a rotor in a joint without a motor, as armature of the joint."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft, JointEffect


@dataclass(frozen=True)
class PassiveRotorInertia(JointEffect):
    """Ia · q̈ in a passive joint, in addition to the armature of the MJCF; it acts on the motors through the loops.

    In a ball joint, it acts in each coordinate of the angular velocity. Ia: kg·m² or kg, at least 0. Balls that only
    close a loop are not joints of the machine and cannot have it.
    """

    name = "passive_rotor_inertia"
    law = "Ia q̈ in a joint without a motor, balls included"
    shares = (0.01, 0.1)
    scaled = ("Ia", 0.01)
    not_negative = ("Ia",)
    where = "passive"
    in_balls = True
    Ia: float

    def change(self, draft: Draft) -> None:
        draft.spec.joint(self.joint).armature += self.Ia
