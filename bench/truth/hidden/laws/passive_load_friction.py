"""Dry friction in a joint without a motor that grows with the force in it."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.dataset.mjcf_neutral import neutral
from bench.truth.hidden.base import Array, Draft, JointEffect, Parameters, hard_friction

FORCE = "hidden:force in joint:"
"""Prefix of a joint's name for the site and the sensor of the force between the bodies that it connects."""


@dataclass(frozen=True)
class PassiveLoadFriction(JointEffect):
    """mu · |F| · sign(q̇) in a passive joint, and sticking at standstill: a plain bearing under load.

    F is the force of MuJoCo's constraints perpendicular to the joint's axis at the previous step, including friction,
    payload and other hidden effects.

    mu: at least 0; N·m/N of a hinge, N/N of a slide.
    """

    name = "passive_load_friction"
    law = "mu |F| sign(q̇) in a joint without a motor, F the force across its axis"
    not_negative = ("mu",)
    shares = (0.004, 0.02)  # mu of millimetres: a coefficient of 0.1 to 0.2 on a pin of centimetres
    where = "passive"
    mu: float

    def change(self, draft: Draft) -> None:
        hard_friction(draft, self.joint)
        joint = draft.spec.joint(self.joint)
        name = FORCE + self.joint
        if any(site.name == name for site in draft.spec.sites):
            return
        turn = np.zeros(4)
        mujoco.mju_quatZ2Vec(turn, np.asarray(joint.axis, dtype=float) / np.linalg.norm(joint.axis))
        joint.parent.add_site(neutral(), name=name, pos=joint.pos, quat=turn)
        draft.spec.add_sensor(
            name=name, type=mujoco.mjtSensor.mjSENS_FORCE, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=name
        )

    @staticmethod
    def bearing_friction(p: Parameters, force: Array) -> Array:
        return p["mu"] * force
