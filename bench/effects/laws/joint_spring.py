"""A spring at a joint."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class JointSpring(ActuatorEffect):
    """A balancing spring or a cable harness.

    Valid for a linear spring. Source: Arakelian and Briot, "Balancing of Linkages and Robot Manipulators", 2015.
    """

    name = "joint_spring"
    law = "τ = k (q − q0) = k q − kq0: a balancing spring or a cable harness."
    symbols = (
        "k: stiffness, positive, N·m/rad or N/m; kq0 = k q0: N·m or N, its torque at joint position zero, "
        "from which the position q0 without torque follows."
    )
    shown_by = "move slowly over the whole range"
    seen = ("position",)
    in_key = ("a straight line at one motor, or what gravity leaves of it, an S",)
    parameters = (EffectParameter("k", "{effort}/{angle}", positive=True), EffectParameter("kq0", "{effort}"))
    in_mjcf = "stiffness"
    at_link = True
    contains = ("constant_offset",)

    def torque(self, joint: JointSignals) -> np.ndarray:
        return np.column_stack((joint.position, -np.ones(len(joint.position))))
