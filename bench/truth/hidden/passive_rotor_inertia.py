"""Inertia of a rotor in a joint without a motor, as armature of the joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bench.truth.hidden.base import Draft, JointEffect


@dataclass(frozen=True)
class PassiveRotorInertia(JointEffect):
    """Ia · q̈ in a passive joint, in each coordinate of a ball joint's angular velocity, in addition to the armature of
    the MJCF; the motors feel it through the loops.

    Ia: kg·m² or kg, at least 0. Balls that close a loop are no joints of the machine: none there.
    """

    name: ClassVar[str] = "passive_rotor_inertia"
    law: ClassVar[str] = "Ia q̈ in a joint without a motor, balls included"
    shares: ClassVar[tuple[float, float]] = (0.01, 0.1)
    scaled: ClassVar[tuple[str, float] | None] = ("Ia", 0.01)
    not_negative: ClassVar[tuple[str, ...]] = ("Ia",)
    where = "passive"
    in_balls: ClassVar[bool] = True
    Ia: float

    def change(self, draft: Draft) -> None:
        draft.spec.joint(self.joint).armature += self.Ia
