"""Viscous friction that differs with the direction, as a torque law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.truth.hidden.base import Array, HiddenEffect, TorqueLaw


@dataclass(frozen=True)
class AsymmetricViscousFriction(HiddenEffect):
    """Fv_plus · q̇ for q̇ > 0, Fv_minus · q̇ for q̇ < 0.

    Fv_plus, Fv_minus: N·m·s/rad or N·s/m, at least 0.
    """

    name: ClassVar[str] = "asymmetric_viscous_friction"
    not_negative: ClassVar[tuple[str, ...]] = ("Fv_plus", "Fv_minus")
    Fv_plus: float
    Fv_minus: float

    def torque_law(self) -> TorqueLaw:
        """The law; it has no state."""

        def law(_time: float, _position: Array, velocity: Array, _motor: Array) -> Array:
            return np.where(velocity > 0, self.Fv_plus, self.Fv_minus) * velocity

        return law
