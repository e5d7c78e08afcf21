"""Viscous friction, as damping of the joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import mujoco

from bench.truth.hidden.base import HiddenEffect


@dataclass(frozen=True)
class ViscousFriction(HiddenEffect):
    """Fv · q̇, at the velocity before the step: the machine integrates damping explicitly.

    Fv: N·m·s/rad or N·s/m, at least 0.
    """

    name: ClassVar[str] = "viscous_friction"
    not_negative: ClassVar[tuple[str, ...]] = ("Fv",)
    Fv: float

    def change(self, spec: mujoco.MjSpec) -> None:
        """Add to the linear coefficient of the joint's damping."""
        joint = spec.joint(self.joint)
        damping = joint.damping.copy()
        damping[0] += self.Fv
        joint.damping = damping
