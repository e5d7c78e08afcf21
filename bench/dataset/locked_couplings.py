"""Equalities and fixed tendons with locked joints, reduced to the joints that are not locked."""

from collections.abc import Mapping

import mujoco
import numpy as np
from numpy.polynomial import Polynomial

from bench.basics.errors import BenchError
from bench.basics.joint_units import joint_units

AGREE = 1e-6  # rad or m: largest gap of an equality whose joints are all locked, as in the home pose
DIGITS = 1e-3  # m or rad: largest gap of a loop of locked joints, whose values may be typed with few digits
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


def drop_equalities(spec: mujoco.MjSpec, plain: mujoco.MjModel, values: Mapping[str, float]) -> None:
    """Remove connects and welds between bodies that locked joints fix to one another, and couplings of locked joints.

    plain: the compiled file, whose equalities have the same indices. Raises BenchError if one is open at the locked
    positions, and if a coupling ties a joint that is not locked to a locked one.
    """
    at = mujoco.MjData(plain)
    for name, value in values.items():
        at.joint(name).qpos[0] = value
    mujoco.mj_fwdPosition(plain, at)
    of_equality = np.asarray(at.efc_type) == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    held = {int(plain.joint(name).id) for name in values}
    for index, equality in enumerate(list(spec.equalities)):
        equality.name = label = equality.name or f"equality_{index}"
        if equality.type in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD):
            first, second = (_moved_with(plain, body, held) for body in held_bodies(plain, index))
            if first != second:
                continue
            # three of position; of a weld, then three of rotation
            gaps = np.abs(at.efc_pos[of_equality & (at.efc_id == index)])
            if gaps.max(initial=0.0) > DIGITS:
                unit = joint_units(rotates=bool(gaps.argmax() >= 3)).position
                raise BenchError(
                    f"loop {label!r} between locked joints is open by {gaps.max():.3g} {unit}: "
                    "lock them where it closes"
                )
        elif equality.type == mujoco.mjtEq.mjEQ_JOINT:
            ends = [name for name in (equality.name1, equality.name2) if name]
            if not set(ends) & set(values):
                continue
            if equality.active:
                held_at = [values.get(name) for name in ends]
                law = Polynomial(np.array(equality.data[:POWERS]))
                _check_equality(plain, label, ends, held_at, law)
        else:
            continue
        spec.delete(equality)


def held_bodies(plain: mujoco.MjModel, equality: int) -> list[int]:
    """The two bodies that a connect or weld holds together."""
    ends = [int(plain.eq_obj1id[equality]), int(plain.eq_obj2id[equality])]
    if int(plain.eq_objtype[equality]) == int(mujoco.mjtObj.mjOBJ_SITE):
        return [int(plain.site_bodyid[site]) for site in ends]
    return ends


def _moved_with(plain: mujoco.MjModel, body: int, held: set[int]) -> int:
    """The nearest ancestor of a body, or itself, with a joint that is not held; 0 if there is none."""
    while body:
        first = int(plain.body_jntadr[body])
        if set(range(first, first + int(plain.body_jntnum[body]))) - held:
            return body
        body = int(plain.body_parentid[body])
    return 0


def _check_equality(
    plain: mujoco.MjModel, label: str, ends: list[str], values: list[float | None], law: Polynomial
) -> None:
    """Raise BenchError unless the locked joints satisfy an equality and it ties no other. values: None: not locked."""
    homes = [_reference(plain, name) for name in ends]
    travels = [None if value is None else value - home for value, home in zip(values, homes, strict=True)]
    first, second = (*travels, 0.0)[:2]
    if law.trim().degree() == 0:
        second = 0.0  # the equality fixes the first joint, independently of the second
    if second is None and first is not None:
        free, other = ends[1], ends[0]
        roots = (law - first).roots()
        travel = min((root.real for root in roots if abs(root.imag) < AGREE), key=abs, default=None)
        if travel is None:
            raise BenchError(f"equality {label!r}: no position of {free!r} allows this one of {other!r}")
        at = float(travel) + homes[1]
        raise BenchError(f"equality {label!r} ties {free!r} to {other!r}: lock it too, {free} = {at:.10g}")
    at, free = float(law(second or 0.0)) + homes[0], ends[0]
    if first is None:
        raise BenchError(f"equality {label!r} ties {free!r} to {ends[1]!r}: lock it too, {free} = {at:.10g}")
    if abs(first + homes[0] - at) > AGREE:
        raise BenchError(f"equality {label!r} holds {free!r} at {at:.10g}: lock it there")


def shorten_tendons(
    spec: mujoco.MjSpec, plain: mujoco.MjModel, values: Mapping[str, float]
) -> tuple[dict[str, float], set[str]]:
    """Remove the locked joints from fixed tendons; equalities between tendons are shifted so that they still hold.

    Returns what the locked joints add to the lengths, and the tendons that had no other joint and are removed.
    """
    lengths: dict[str, float] = {}
    travels: dict[str, float] = {}
    empty: set[str] = set()
    for tendon in list(spec.tendons):
        path = [tendon.path[i] for i in range(len(tendon.path))]
        on_joints = (wrap for wrap in path if wrap.type == mujoco.mjtWrap.mjWRAP_JOINT)
        joints = [(wrap.target.name, float(wrap.coef)) for wrap in on_joints]
        held = [(name, factor) for name, factor in joints if name in values]
        if not held:
            continue
        name = tendon.name
        lengths[name] = sum(factor * values[joint] for joint, factor in held)
        travels[name] = sum(factor * (values[joint] - _reference(plain, joint)) for joint, factor in held)
        others = [(joint, factor) for joint, factor in joints if joint not in values]
        fields = {
            field: value.copy() if isinstance(value := getattr(tendon, field), np.ndarray) else value
            for field in COPIED
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
    for equality in list(spec.equalities):
        if equality.type == mujoco.mjtEq.mjEQ_TENDON:
            _shift(spec, equality, travels, empty)
    return lengths, empty


def _shift(
    spec: mujoco.MjSpec, equality: mujoco.MjsEquality, travels: Mapping[str, float], empty: set[str]
) -> None:
    """Rewrite an equality first = p(second) for tendons that are shorter by their locked joints' travel from qpos0."""
    label, first, second = equality.name, equality.name1, equality.name2
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
    equality.data[:POWERS] = np.pad(law.coef, (0, POWERS - len(law.coef)))


def _reference(plain: mujoco.MjModel, joint: str) -> float:
    return float(plain.qpos0[plain.jnt_qposadr[plain.joint(joint).id]])
