"""Viscous friction that changes with the position; not in the catalogue of effects."""

from dataclasses import dataclass

from bench.truth.hidden.base import (
    JointEffect,
    JointMovement,
    Law,
    Parameters,
    Signals,
    Sizes,
    harmonic,
    wave_sizes,
)


@dataclass(frozen=True)
class PositionDependentViscousFriction(JointEffect):
    """(a · cos(h q) + b · sin(h q)) · q̇: unevenly distributed grease.

    a, b: N·m·s/rad or N·s/m.  harmonic: h, 1 if omitted; 1/rad, or 1/m for a slide.
    """

    name = "position_dependent_viscous_friction"
    law = "(a cos hq + b sin hq) q̇"
    positive = ("harmonic",)
    in_catalogue = False
    a: float
    b: float
    harmonic: float = 1.0

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        return lambda: harmonic(p, s.position, p["harmonic"]) * s.velocity

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return wave_sizes(j, j.velocity, share)
