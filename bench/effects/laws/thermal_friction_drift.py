"""Friction that changes as the joint warms up."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter, ShapeParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class ThermalFrictionDrift(ActuatorEffect):
    """Friction of a cold joint in addition to that when warm.

    Valid for motion that heats evenly; a T far above the recording's duration is a steady drift. Source:
    Bittencourt and Gunnarsson, "Static friction in a robot joint: modeling and identification of load and
    temperature effects", Journal of Dynamic Systems, Measurement, and Control 134(5), 2012.
    """

    name = "thermal_friction_drift"
    law = "τ = (Fc sign(q̇) + Fv q̇) exp(−t/T): what a cold joint has in addition to its friction when warm."
    symbols = (
        "t: time from the start of the recording, at which the joint is cold; Fc N·m or N, Fv N·m·s/rad or "
        "N·s/m, mostly positive, negative where friction grows; T: time constant, s, estimated from the data. "
        "The friction of the warm joint is an effect of its own."
    )
    shown_by = "start cold and record for longer"
    seen = ("fades", "opposes", "velocity")
    in_key = (
        "fades or grows in the course of a recording",
        "",
        "a fan: a line whose slope changes in the course of a recording",
    )
    parameters = (EffectParameter("Fc", "{effort}"), EffectParameter("Fv", "{effort}*s/{angle}"))
    by_motor = True
    shape = (ShapeParameter("T", "s", (0.05, 0.1, 0.2, 0.4, 0.8, 2.0), scale="duration"),)
    every_sample = True

    T: float = 10.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        cold = np.exp(-joint.time / self.T)
        return cold[:, None] * np.column_stack((np.sign(joint.velocity), joint.velocity))
