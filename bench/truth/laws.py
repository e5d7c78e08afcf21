"""The laws of hidden effects, for the joints that have them, over the live state of a simulation."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.truth.assembly import Indices, as_slice
from bench.truth.hidden import HiddenEffect, JointEffect, Law, Signals, has_law
from bench.truth.hidden.passive_load_friction import FORCE
from bench.truth.machine import Machine

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointLaw:
    """One law for some of the actuated joints."""

    columns: slice
    """Of the arrays (R, n) of the actuated joints."""
    value: Law


def joint_laws(
    hidden: Sequence[HiddenEffect], name: str, signals: Signals, dofs: Indices
) -> tuple[JointLaw, ...]:
    """The laws `name` of all effects that have one; equal effects in several joints are one law.

    signals: of all actuated joints.  dofs: (n,) their velocity indices.
    """
    joints = signals.joints
    laws = []
    for group in _groups([e for e in hidden if isinstance(e, JointEffect) and has_law(e, name)], joints):
        for columns, effects in _evenly_spaced(group, joints, dofs):
            parameters = {
                field.name: np.array([getattr(effect, field.name) for effect in effects], dtype=float)
                for field in fields(effects[0])
                if field.name != "joint"
            }
            law = getattr(effects[0], name)(parameters, signals.columns(columns))
            if law is not None:
                laws.append(JointLaw(columns, law))
    return tuple(laws)


def _groups(effects: Sequence[JointEffect], joints: Sequence[str]) -> Iterator[list[JointEffect]]:
    """Effects of one kind, each joint at most once, in the order of `joints`."""
    remaining = list(effects)
    while remaining:
        group: dict[str, JointEffect] = {}
        for effect in remaining:
            if type(effect) is type(remaining[0]):
                group.setdefault(effect.joint, effect)
        remaining = [effect for effect in remaining if group.get(effect.joint) is not effect]
        yield sorted(group.values(), key=lambda effect: joints.index(effect.joint))


def _evenly_spaced(
    group: list[JointEffect], joints: Sequence[str], dofs: Indices
) -> Iterator[tuple[slice, list[JointEffect]]]:
    """The group if its joints and their velocities are evenly spaced, so that views serve; else one by one."""
    numbers = np.array([joints.index(effect.joint) for effect in group])
    columns = as_slice(numbers)
    if columns is not None and as_slice(dofs[numbers]) is not None:
        yield columns, group
        return
    for number, effect in zip(numbers.tolist(), group, strict=True):
        yield slice(number, number + 1), [effect]


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
