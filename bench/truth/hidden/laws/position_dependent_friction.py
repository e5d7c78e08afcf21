"""Dry friction that changes with the position."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import (
    DryFriction,
    JointMovement,
    Law,
    Parameters,
    Signals,
    Sizes,
    harmonic,
    wave_sizes,
)


@dataclass(frozen=True)
class PositionDependentFriction(DryFriction):
    """(a · cos(h q) + b · sin(h q)) · sign(q̇), and sticking at standstill: a bent shaft, a tight spot.

    Friction cannot be negative: if the dry friction of the joint, other effects included, becomes negative, the
    simulation ends with an error.

    a, b: N·m or N.  harmonic: h, 1 if omitted; 1/rad, or 1/m for a slide.
    """

    name = "position_dependent_friction"
    law = "(a cos hq + b sin hq) sign(q̇); not negative"
    positive = ("harmonic",)
    a: float
    b: float
    harmonic: float = 1.0

    @staticmethod
    def dry_friction(p: Parameters, s: Signals) -> Law:
        return lambda: harmonic(p, s.position, p["harmonic"])

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return wave_sizes(j, np.ones_like(j.position), share)
