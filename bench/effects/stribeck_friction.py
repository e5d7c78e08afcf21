"""Stribeck friction."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter, ShapeParameter
from bench.effects.signals import JointSignals

EXPONENT = 2.0  # delta: 0.5 to 2 are in use; the data of a moving robot hardly tell them apart


@dataclass(frozen=True)
class StribeckFriction(ActuatorEffect):
    """tau = (Fc + Fs exp(-|qd/vs|^delta)) sign(qd): dry friction that is larger where the joint moves slowly.

    Fc: Coulomb friction, Fs: what is added at the slowest motion, positive, N*m or N; vs: Stribeck velocity, found
    from the data, rad/s or m/s; delta = 2. Valid while the joint slides; a vs far below the speeds of the motion
    cannot be seen. Source: Bo and Pavelescu, "The friction-speed relation and its influence on the critical
    velocity of stick-slip motion", Wear 82, 1982; Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE
    Transactions on Automatic Control 40(3), 1995 (delta = 2).
    """

    name = "stribeck_friction"
    parameters = (
        EffectParameter("Fc", "{effort}", positive=True),
        EffectParameter("Fs", "{effort}", positive=True),
    )
    shape = (ShapeParameter("vs", "{angle}/s", (0.02, 0.05, 0.1, 0.2, 0.4, 0.8), scale="speed"),)
    contains = ("coulomb_friction",)

    vs: float = 0.1

    def torque(self, joint: JointSignals) -> np.ndarray:
        direction = np.sign(joint.velocity)
        slowness = np.exp(-(np.abs(joint.velocity / self.vs) ** EXPONENT))
        return np.column_stack((direction, slowness * direction))
