"""Stribeck friction."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter, ShapeParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class StribeckFriction(ActuatorEffect):
    """Dry friction that is larger at low speed.

    Valid while the joint slides; a vs far below the speeds of the motion cannot be seen. Source: Bo and Pavelescu,
    "The friction-speed relation and its influence on the critical velocity of stick-slip motion", Wear 82, 1982;
    Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Transactions on Automatic Control 40(3), 1995 (delta = 2);
    Tustin, Journal of the IEE 94, 1947 (delta = 1).
    """

    name = "stribeck_friction"
    law = (
        "τ = (Fc + Fs exp(−|q̇/vs|^delta)) sign(q̇): dry friction that is larger where the joint moves slowly."
    )
    symbols = (
        "Fc: Coulomb friction, Fs: what is added at the slowest motion, positive, N·m or N; vs: Stribeck "
        "velocity, rad/s or m/s, and delta: 1 or 2, both estimated from the data."
    )
    shown_by = "reverse slowly"
    seen = ("opposes",)
    in_key = ("is larger just after a reversal, and falls with the speed",)
    of_velocity = True
    parameters = (
        EffectParameter("Fc", "{effort}", positive=True),
        EffectParameter("Fs", "{effort}", positive=True),
    )
    by_motor = True
    shape = (
        ShapeParameter("vs", "{angle}/s", (0.02, 0.05, 0.1, 0.2, 0.4, 0.8), scale="speed"),
        ShapeParameter("delta", "1", (1.0, 2.0), discrete=True),
    )
    every_sample = True
    contains = ("coulomb_friction",)

    vs: float = 0.1
    delta: float = 2.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        direction = np.sign(joint.velocity)
        slowness = np.exp(-(np.abs(joint.velocity / self.vs) ** self.delta))
        return np.column_stack((direction, slowness * direction))
