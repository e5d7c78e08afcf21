"""Joints without a motor whose friction follows from the force that MuJoCo's constraints make them bear."""

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.truth.hidden import JointEffect, has_law
from bench.truth.hidden.passive_load_friction import FORCE
from bench.truth.machine import Machine

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BearingFriction:
    """The dry friction of one joint of R runs: where it is among the velocities, and its size (R,) at a step."""

    dof: int
    size: Callable[[], Array]


def bearings_of(machine: Machine, batch: Batch) -> tuple[BearingFriction, ...]:
    """One for each joint with such friction, that of the joint itself included."""
    model = machine.models[None]
    by_joint: dict[str, list[JointEffect]] = {}
    for effect in machine.hidden:
        if isinstance(effect, JointEffect) and has_law(effect, "bearing_friction"):
            by_joint.setdefault(effect.joint, []).append(effect)
    if not by_joint:
        return ()
    readings = batch.bind("sensordata")
    bearings = []
    for joint, effects in by_joint.items():
        dof = int(model.joint(joint).dofadr[0])
        at = int(model.sensor(FORCE + joint).adr[0])
        bearings.append(
            BearingFriction(dof, _size(effects, readings[:, at : at + 2], float(model.dof_frictionloss[dof])))
        )
    return tuple(bearings)


def _size(effects: list[JointEffect], across: Array, base: float) -> Callable[[], Array]:
    """Of a joint's friction; across: live force (R, 2) in the site's x and y, whose z is the joint's axis."""
    parameters = [
        {
            field.name: np.array([getattr(effect, field.name)])
            for field in fields(effect)
            if field.name != "joint"
        }
        for effect in effects
    ]

    def size() -> Array:
        force = np.linalg.norm(across, axis=1)[:, None]
        total = np.full(len(force), base)
        for effect, values in zip(effects, parameters, strict=True):
            added = effect.bearing_friction(values, force)
            if added is not None:
                total += added[:, 0]
        return total

    return size
