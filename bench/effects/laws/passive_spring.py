"""A spring in a joint without a motor."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import EffectParameter
from bench.effects.passive_joint import PassiveEffect


@dataclass(frozen=True)
class PassiveSpring(PassiveEffect):
    """A spring in a passive joint p, carried to the motors by the loops.

    Valid for a linear spring: a balancing spring in a linkage, a flexure joint. Source: Arakelian and Briot, "Balancing
    of Linkages and Robot Manipulators", 2015.
    """

    name = "passive_spring"
    law = "τ = J_p' (k q_p − kq0): a spring in a passive joint p, carried to the motors by the loops."
    symbols = (
        "k: stiffness, positive, N·m/rad or N/m; kq0 = k q0: N·m or N, its torque at joint position zero, "
        "from which the position q0 without torque follows; q_p: position of the passive joint, as the MJCF counts "
        "it; J_p (1, n): its velocity for the motors' velocities."
    )
    shown_by = "move slowly over the whole range"
    seen = ("position",)
    in_key = ("a curve at several motors, that of a spring in a joint without a motor",)
    parameters = (EffectParameter("k", "{effort}/{angle}", positive=True), EffectParameter("kq0", "{effort}"))
    in_mjcf = "stiffness"

    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:  # noqa: ARG002 - of the position alone
        return np.stack((position, -np.ones_like(position)), axis=2)
