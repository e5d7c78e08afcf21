"""The laws of hidden effects, for the joints that have them, over the live state of a simulation."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from bench.truth.hidden import HiddenEffect, JointEffect, Law, Signals, has_law
from bench.truth.indices import Indices, as_slice

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
