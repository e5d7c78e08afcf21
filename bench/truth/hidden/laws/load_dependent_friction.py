"""Dry friction that grows with the transmitted torque."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import DryFriction, JointMovement, Law, Parameters, Signals, Sizes


@dataclass(frozen=True)
class LoadDependentFriction(DryFriction):
    """mu · |τ| · sign(q̇), and sticking at standstill: gears and bearings under load.

    τ is the torque of the motor, friction included. The controller commands it from the state before the step, which
    avoids an algebraic loop. In terms of the torque without friction, the coefficient would be mu / (1 ∓ mu), with
    the sign of τ q̇.

    mu: at least 0, less than 1.
    """

    name = "load_dependent_friction"
    law = "mu |τ| sign(q̇), τ of the motor"
    not_negative = ("mu",)
    mu: float

    @staticmethod
    def dry_friction(p: Parameters, s: Signals) -> Law:
        return lambda: p["mu"] * np.abs(s.torque)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:  # noqa: ARG004 - a share of any torque
        return {"mu": share}
