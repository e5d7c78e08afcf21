"""Additional friction of a cold joint."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import Array, DryFriction, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class ThermalFrictionDrift(DryFriction):
    """(Fv · q̇ + Fc · sign(q̇)) · exp(-t / T): friction of a cold joint in addition to that of a warm one.

    Every recording begins with a cold joint at t = 0. The friction of the warm joint is a separate effect.

    Fv: N·m·s/rad or N·s/m.  Fc: N·m or N; both at least 0, and 0 if omitted.  T: time constant, s.
    """

    name = "thermal_friction_drift"
    law = "(Fv q̇ + Fc sign(q̇)) exp(−t/T), every recording from cold"
    positive = ("T",)
    not_negative = ("Fv", "Fc")
    T: float
    Fv: float = 0.0
    Fc: float = 0.0

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        return lambda: p["Fv"] * np.exp(-max(s.clock.time, 0.0) / p["T"]) * s.velocity

    @staticmethod
    def dry_friction(p: Parameters, s: Signals) -> Law:
        size = np.zeros_like(s.velocity)

        def law() -> Array:
            size[:] = p["Fc"] * np.exp(-max(s.clock.time, 0.0) / p["T"])
            return size

        return law

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        """Viscous friction that falls to about a third within a third of the recording."""
        cooling = 0.3 * j.duration
        return {"T": cooling, "Fv": share * rms(j.torque) / rms(j.velocity * np.exp(-j.time / cooling))}
