"""Inertia of what turns with a joint without a motor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import EffectParameter
from bench.effects.passive_joint import PassiveEffect


@dataclass(frozen=True)
class PassiveRotorInertia(PassiveEffect):
    """Inertia of a rotor, gear or encoder that turns with a passive joint p, carried to the motors by the loops.

    A rotor behind a gear counts with the gear ratio squared. The inertias of the joint's two bodies absorb most of it,
    and all of it if one of the two, such as the base, never turns about the joint's axis. In a ball joint it acts on
    each component of the angular velocity in the body's frame, as MuJoCo's armature does. Valid for a stiff gear; for
    balls at both ends of a rod if they have the same inertia and the rod almost none about its line
    (`bench.model.body_rates`). Source: Khalil and Dombre, "Modeling, Identification and Control of Robots", 2002, 9.3
    (inertia of a rotor); Briot and Khalil, "Dynamics of Parallel Robots", 2015, chapter 8 (principle of virtual work).
    """

    name = "passive_rotor_inertia"
    law = (
        "τ = J_p' Ia q̈_p: inertia of a rotor, gear or encoder that turns with a passive joint p, carried to the motors "
        "by the loops."
    )
    symbols = (
        "Ia: positive, kg·m² or kg; q̈_p: acceleration of the passive joint, of a ball joint the rate of its angular "
        "velocity (3); J_p (1, n) or (3, n): its velocity for the motors' velocities."
    )
    shown_by = "move one motor alone, fast, over the whole range"
    seen = ("acceleration",)
    in_key = (
        "is small, there at several motors at once, and goes by the acceleration of a joint without a motor",
    )
    parameters = (EffectParameter("Ia", "{effort}*s^2/{angle}", positive=True),)
    in_balls = True
    in_mjcf = "armature"

    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:  # noqa: ARG002 - of the acceleration alone
        return acceleration[:, :, None]
