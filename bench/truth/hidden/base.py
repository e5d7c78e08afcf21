"""What a hidden effect is: a change of the MuJoCo model, or a torque law of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TorqueLaw = Callable[[float, Array, Array, Array], Array]
"""Opposing torque (R,) from time (s), position, velocity and motor torque (R,) of R recordings at once."""


@dataclass(frozen=True)
class HiddenEffect:
    """An effect in one joint of the simulated machine; the fields of a subclass are its parameters.

    A parameter opposes the motion: the torque of the law has to be supplied by the motor in addition to
    what the rigid body needs, g i = τ_rigid + law. Torques stand for forces where the joint is a slide.
    An effect that MuJoCo has overrides `change`; any other overrides `torque_law`.
    """

    name: ClassVar[str]
    not_negative: ClassVar[tuple[str, ...]] = ()
    """Parameters that physics keeps from being negative."""
    joint: str

    def change(self, spec: mujoco.MjSpec) -> None:
        """Add the effect to the uncompiled model."""

    def torque_law(self) -> TorqueLaw | None:
        """A law evaluated at every step, with a state of its own if it has one; None if there is none."""
        return None
