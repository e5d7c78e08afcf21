"""A constant torque, as an actuator that nobody commands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import mujoco

from bench.truth.hidden.base import HiddenEffect


@dataclass(frozen=True)
class ConstantOffset(HiddenEffect):
    """c: an amplifier's offset, or the part of Coulomb friction that has a direction.

    c: N·m or N, either sign; what the motor has to supply, so that -c acts on the joint.
    """

    name: ClassVar[str] = "constant_offset"
    c: float

    def change(self, spec: mujoco.MjSpec) -> None:
        """Add an actuator whose force does not depend on its control."""
        actuator = spec.add_actuator(name=f"hidden:constant_offset:{self.joint}", target=self.joint)
        actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
        actuator.gaintype = mujoco.mjtGain.mjGAIN_FIXED
        actuator.gainprm[0] = 0.0
        actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        actuator.biasprm[0] = -self.c
