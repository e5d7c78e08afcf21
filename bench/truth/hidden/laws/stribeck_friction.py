"""Dry friction that falls with the speed."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import DryFriction, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class StribeckFriction(DryFriction):
    """(Fc + Fs · exp(-|q̇ / vs|^delta)) · sign(q̇), and sticking at standstill up to Fc + Fs.

    The friction constraint of the joint is set to this size before every step.

    Fc, Fs: N·m or N, at least 0.  vs: Stribeck velocity, rad/s or m/s.  delta: 2 (Gaussian) if omitted.
    """

    name = "stribeck_friction"
    law = "(Fc + Fs exp(−|q̇/vs|^delta)) sign(q̇)"
    positive = ("vs", "delta")
    not_negative = ("Fc", "Fs")
    Fc: float
    Fs: float
    vs: float
    delta: float = 2.0

    @staticmethod
    def dry_friction(p: Parameters, s: Signals) -> Law:
        return lambda: p["Fc"] + p["Fs"] * np.exp(-((np.abs(s.velocity) / p["vs"]) ** p["delta"]))

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        """At low speed twice the friction, which falls around a fifth of the RMS speed."""
        vs = 0.2 * rms(j.velocity)
        unit = rms(1 + np.exp(-((j.velocity / vs) ** 2)))
        size = share * rms(j.torque) / unit
        return {"Fc": size, "Fs": size, "vs": vs}
