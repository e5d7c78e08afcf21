"""Equalities and fixed tendons that name a locked joint: what remains of them for the other joints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import Polynomial

from bench.basics.errors import BenchError

if TYPE_CHECKING:
    import mujoco

AGREE = 1e-6  # rad or m: by so much an equality may be open where all its joints are locked, as at home
POWERS = 5  # coefficients of an equality's polynomial
COPIED = (  # fields of a tendon
    *(
        "actfrclimited",
        "actfrcrange",
        "armature",
        "damping",
        "frictionloss",
        "group",
        "info",
        "limited",
        "margin",
    ),
    *(
        "material",
        "rgba",
        "solimp_friction",
        "solimp_limit",
        "solref_friction",
        "solref_limit",
        "springyield",
    ),
    *("stiffness", "userdata", "width"),
)


def drop_joint_equalities(spec: mujoco.MjSpec, plain: mujoco.MjModel, values: Mapping[str, float]) -> None:
    """Take out the joint equalities between locked joints.

    Raises BenchError where one holds a joint that is not locked, with the position that it is held at, and where the
    values contradict one.
    """
    import mujoco  # noqa: PLC0415 - slow to import: only once a robot is really read

    for index, equality in enumerate(list(spec.equalities)):
        ends = [name for name in (equality.name1, equality.name2) if name]
        if equality.type != mujoco.mjtEq.mjEQ_JOINT or not set(ends) & set(values):
            continue
        label = equality.name or f"equality_{index}"
        if plain.eq_active0[index]:
            travels = [values[name] - _reference(plain, name) if name in values else None for name in ends]
            _check_equality(plain, label, ends, travels, Polynomial(np.array(equality.data[:POWERS])))
        spec.delete(equality)


def _check_equality(
    plain: mujoco.MjModel, label: str, ends: list[str], travels: list[float | None], law: Polynomial
) -> None:
    """travels: of the locked joints from qpos0, None of one that is not locked."""
    first, second = (*travels, 0.0)[:2]
    if law.trim().degree() == 0:
        second = 0.0  # it holds the first joint, whatever the second does
    if second is None and first is not None:
        free, other = ends[1], ends[0]
        roots = (law - first).roots()
        travel = min((root.real for root in roots if abs(root.imag) < AGREE), key=abs, default=None)
        if travel is None:
            raise BenchError(f"equality {label!r}: no position of {free!r} allows this one of {other!r}")
        at = float(travel) + _reference(plain, free)
        raise BenchError(f"equality {label!r} ties {free!r} to {other!r}: lock it too, {free} = {at:.10g}")
    at = float(law(second or 0.0)) + _reference(plain, ends[0])
    if first is None:
        raise BenchError(
            f"equality {label!r} ties {ends[0]!r} to {ends[1]!r}: lock it too, {ends[0]} = {at:.10g}"
        )
    if abs(first + _reference(plain, ends[0]) - at) > AGREE:
        raise BenchError(f"equality {label!r} holds {ends[0]!r} at {at:.10g}: lock it there")


def shorten_tendons(
    spec: mujoco.MjSpec, plain: mujoco.MjModel, values: Mapping[str, float]
) -> tuple[dict[str, float], set[str]]:
    """Take the locked joints out of fixed tendons; equalities between tendons stay as they are for the others.

    Returns what the locked joints add to the lengths, and the tendons that had no other joint and are gone.
    """
    import mujoco  # noqa: PLC0415 - likewise

    lengths: dict[str, float] = {}
    travels: dict[str, float] = {}
    empty: set[str] = set()
    for tendon in list(spec.tendons):
        path = [tendon.path[i] for i in range(len(tendon.path))]
        joints = [
            (wrap.target.name, float(wrap.coef)) for wrap in path if wrap.type == mujoco.mjtWrap.mjWRAP_JOINT
        ]
        held = [(name, factor) for name, factor in joints if name in values]
        if not held:
            continue
        name = tendon.name
        lengths[name] = sum(factor * values[joint] for joint, factor in held)
        travels[name] = sum(factor * (values[joint] - _reference(plain, joint)) for joint, factor in held)
        others = [(joint, factor) for joint, factor in joints if joint not in values]
        fields = {field: getattr(tendon, field) for field in COPIED}
        fields = {
            field: value.copy() if isinstance(value, np.ndarray) else value for field, value in fields.items()
        }
        ends = np.array(tendon.range) - lengths[name]
        relaxed = plain.tendon_lengthspring[plain.tendon(name).id] - lengths[name]
        spec.delete(tendon)
        if not others:
            empty.add(name)
            continue
        shorter = spec.add_tendon(name=name, range=ends, springlength=relaxed)
        for field, value in fields.items():
            setattr(shorter, field, value)
        for joint, factor in others:
            shorter.wrap_joint(joint, factor)
    for index, equality in enumerate(list(spec.equalities)):
        if equality.type == mujoco.mjtEq.mjEQ_TENDON:
            _shift(spec, equality, equality.name or f"equality_{index}", travels, empty)
    return lengths, empty


def _shift(
    spec: mujoco.MjSpec,
    equality: mujoco.MjsEquality,
    label: str,
    travels: Mapping[str, float],
    empty: set[str],
) -> None:
    """An equality first = p(second) of tendons that are shorter by their locked joints' travel from qpos0."""
    first, second = equality.name1, equality.name2
    if not {first, second} & set(travels):
        return
    law = Polynomial(np.array(equality.data[:POWERS])) if second else Polynomial(equality.data[0])
    law = law(Polynomial([travels.get(second, 0.0), 1.0])) - travels.get(first, 0.0)
    if first in empty and (not second or second in empty):
        if equality.active and abs(law(0.0)) > AGREE:
            raise BenchError(f"equality {label!r} of tendons is open by {abs(law(0.0)):.3g} at these values")
        spec.delete(equality)
        return
    if first in empty:
        raise BenchError(f"equality {label!r} ties tendon {second!r} to locked joints: lock its joints too")
    if second in empty:
        equality.name2, law = "", Polynomial(law(0.0))
    numbers = np.zeros(POWERS)
    numbers[: len(law.coef)] = law.coef
    equality.data[:POWERS] = numbers


def _reference(plain: mujoco.MjModel, joint: str) -> float:
    return float(plain.qpos0[plain.jnt_qposadr[plain.joint(joint).id]])
