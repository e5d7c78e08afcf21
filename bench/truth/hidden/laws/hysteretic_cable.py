"""A cable or hose with hysteresis in bending."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import (
    Draft,
    JointEffect,
    JointMovement,
    Law,
    Parameters,
    Signals,
    Sizes,
    refuse_fast_swing,
    rms,
)


@dataclass(frozen=True)
class HystereticCable(JointEffect):
    """F z, dz/dt = q̇ / reach − |q̇| |z|^(sharpness − 1) z / reach (Bouc and Wen's hysteresis).

    Each step of the simulation is one midpoint step along the displacement of the joint.

    Wen, "Method for random vibration of hysteretic systems", Journal of the Engineering Mechanics Division 102 (1976).

    F: N·m or N.  reach: rad or m.  sharpness: at least 1.
    """

    name = "hysteretic_cable"
    law = "Bouc and Wen: F z, reach dz/dt = q̇ − |q̇| |z|^(sharpness−1) z"
    positive = ("F", "reach", "sharpness")
    F: float
    reach: float
    sharpness: float = 2.0

    def change(self, draft: Draft) -> None:
        refuse_fast_swing(draft, self, self.F / self.reach, draft.motor_inertia(self.joint))

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        z, before = np.zeros_like(s.position), s.position.copy()

        def slope(state: np.ndarray, forwards: np.ndarray) -> np.ndarray:
            return np.asarray(1.0 - forwards * np.sign(state) * np.abs(state) ** p["sharpness"])

        def law() -> np.ndarray:
            way = (s.position - before) / p["reach"]
            forwards = np.sign(way)
            middle = z + 0.5 * way * slope(z, forwards)
            z[:] = np.clip(z + way * slope(middle, forwards), -1.0, 1.0)
            before[:] = s.position
            return p["F"] * z

        return law

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        """The torque is nearly full after a fifth of the span."""
        return {"F": share * rms(j.torque), "reach": 0.1 * j.span}
