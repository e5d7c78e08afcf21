"""Coulomb friction, as a friction constraint of the joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import mujoco

from bench.truth.hidden.base import HiddenEffect


@dataclass(frozen=True)
class CoulombFriction(HiddenEffect):
    """Fc · sign(q̇), and sticking at standstill, where the joint takes what it needs up to Fc.

    MuJoCo's friction constraint brings a slow joint to rest within the time constant of its `solref`. With
    two steps, the shortest that is stable, the full Fc acts to rounding as soon as a joint moves faster than
    a few times (acceleration that Fc gives to the joint) · step, some 1e-3 rad/s. With the default of 0.02 s
    that would take 0.1 rad/s.

    Fc: N·m or N, at least 0.
    """

    name: ClassVar[str] = "coulomb_friction"
    not_negative: ClassVar[tuple[str, ...]] = ("Fc",)
    Fc: float

    def change(self, spec: mujoco.MjSpec) -> None:
        """Add to the joint's friction and make its constraint as hard as the step allows."""
        joint = spec.joint(self.joint)
        joint.frictionloss += self.Fc
        joint.solref_friction = [2 * spec.option.timestep, 1.0]
        joint.solimp_friction = [0.9999, 0.99999, 0.001, 0.5, 2.0]
