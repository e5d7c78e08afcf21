"""Joints that robot.toml locks: they are removed from the MJCF, and their motion goes into the pose of their body.

A body with the pose P and the joints J1 ... Jk is at P J1(q1) ... Jk(qk). With joint l held at the motion L, P J1 ...
L ... Jk = (P L) (L^-1 J1 L) ... Jk: the pose of the body becomes P L, the joints before l are transformed by L^-1,
and those after it do not change.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import mujoco
import numpy as np

from bench.basics.errors import BenchError, meant
from bench.dataset.locked_couplings import drop_equalities, shorten_tendons
from bench.dataset.mjcf_neutral import neutral

ROUNDED = 0.01  # of a range's width: tolerance beyond its ends for values typed with few digits
ANCHOR = "locked:"  # prefix of the names of sites that become the anchors of a connect


@dataclass(frozen=True)
class LockedJoint:
    """A hinge or slide that is held. value: joint coordinate of the MJCF, rad or m."""

    name: str
    value: float
    unit: Literal["rad", "m"]


def locked_joints(plain: mujoco.MjModel, values: Mapping[str, float]) -> tuple[LockedJoint, ...]:
    """The joints of the table [locked], checked against the compiled file.

    Raises BenchError for an unknown joint, a ball or free joint, and a value beyond the joint's range.
    """
    units: dict[int, Literal["rad", "m"]] = {
        int(mujoco.mjtJoint.mjJNT_HINGE): "rad",
        int(mujoco.mjtJoint.mjJNT_SLIDE): "m",
    }
    names = [plain.joint(i).name for i in range(plain.njnt)]
    known = [name for name in names if name]
    locked = []
    for name, value in values.items():
        if name not in names:
            raise BenchError(f"no joint {name!r}: {meant(name, known, 'the MJCF has')}")
        joint = names.index(name)
        unit = units.get(int(plain.jnt_type[joint]))
        if unit is None:
            raise BenchError(
                f"{name!r} is a ball or free joint; hinges and slides can be locked: remove it from the MJCF"
            )
        low, high = plain.jnt_range[joint].tolist()
        beyond = ROUNDED * (high - low)
        if plain.jnt_limited[joint] and not low - beyond <= value <= high + beyond:
            degrees = f" ({value:g} degrees are {np.deg2rad(value):.6g} rad)" if unit == "rad" else ""
            raise BenchError(
                f"{name} = {value:g} {unit} is outside its range [{low:.6g}, {high:.6g}]{degrees}"
            )
        locked.append(LockedJoint(name, value, unit))
    return tuple(locked)


def locked_as_data(locked: Sequence[LockedJoint]) -> dict[str, dict[str, Any]]:
    """Locked joints as plain data: name -> value and unit."""
    return {joint.name: {"value": joint.value, "unit": joint.unit} for joint in locked}


def locked_from_data(content: Mapping[str, Mapping[str, Any]]) -> tuple[LockedJoint, ...]:
    """The inverse of `locked_as_data`. Raises KeyError, TypeError or ValueError for other data."""
    return tuple(LockedJoint(name, float(entry["value"]), entry["unit"]) for name, entry in content.items())


def locked_in_words(locked: Sequence[LockedJoint]) -> str:
    """A text such as "gripper = 0.3 rad, rail = 0.1 m"; "nothing" if no joint is locked."""
    return ", ".join(f"{joint.name} = {joint.value:g} {joint.unit}" for joint in locked) or "nothing"


def lock_joints(spec: mujoco.MjSpec, locked: Sequence[LockedJoint]) -> dict[str, float]:
    """Remove the locked joints, and the parts that refer to them, from a file before compilation.

    Returns their contribution to the length of each fixed tendon, rad or m, which the shortened tendon lacks. Raises
    BenchError for an equality that ties another joint to a locked one, or that the values violate.
    """
    plain = spec.compile()
    values = {joint.name: joint.value for joint in locked}
    joints = [int(plain.joint(name).id) for name in values]
    by_id = {joint.id: joint for joint in spec.joints}  # as in `plain`, until the file changes
    keyframes = _without_keyframes(spec)  # MuJoCo empties them when a joint is removed
    _keep_anchors(spec, plain)
    drop_equalities(spec, plain, values)
    lengths, empty = shorten_tendons(spec, plain, values)
    motors = _drop_actuators(spec, {*values, *empty})
    for body in dict.fromkeys(int(plain.jnt_bodyid[joint]) for joint in joints):
        _fold(spec, plain, body, values, by_id)
    _shorten_keyframes(spec, plain, keyframes, joints, motors)
    return lengths


def _keep_anchors(spec: mujoco.MjSpec, plain: mujoco.MjModel) -> None:
    """Make the anchors of equalities of bodies explicit: MuJoCo derives them at qpos0, from which locks differ."""
    for index, equality in enumerate(spec.equalities):
        if int(plain.eq_objtype[index]) != int(mujoco.mjtObj.mjOBJ_BODY):
            continue
        if equality.type == mujoco.mjtEq.mjEQ_WELD:
            equality.data[:10] = plain.eq_data[index, :10]
        elif equality.type == mujoco.mjtEq.mjEQ_CONNECT:
            names = []
            for end, body in enumerate((equality.name1, equality.name2)):
                place = plain.eq_data[index, 3 * end : 3 * end + 3]
                names.append(f"{ANCHOR}{index}:{end}")
                spec.body(body or "world").add_site(neutral(), name=names[-1], pos=place)
            equality.objtype, equality.data = mujoco.mjtObj.mjOBJ_SITE, np.zeros(len(equality.data))
            equality.name1, equality.name2 = names


def _drop_actuators(spec: mujoco.MjSpec, gone: set[str]) -> list[int]:
    """Remove the actuators and sensors of removed joints and tendons; return the indices of these actuators."""
    elsewhere = (mujoco.mjtTrn.mjTRN_SITE, mujoco.mjtTrn.mjTRN_BODY, mujoco.mjtTrn.mjTRN_SLIDERCRANK)
    motors = {
        i: motor
        for i, motor in enumerate(spec.actuators)
        if motor.trntype not in elsewhere and motor.target in gone
    }
    named = dict.fromkeys((mujoco.mjtObj.mjOBJ_JOINT, mujoco.mjtObj.mjOBJ_TENDON), gone)
    named[mujoco.mjtObj.mjOBJ_ACTUATOR] = {motor.name for motor in motors.values()}
    for sensor in list(spec.sensors):
        if sensor.objname in named.get(sensor.objtype, ()):
            spec.delete(sensor)
    for motor in motors.values():
        spec.delete(motor)
    return list(motors)


def _without_keyframes(spec: mujoco.MjSpec) -> list[dict[str, Any]]:
    """Remove the keyframes and return their values by field."""
    fields, said = ("qpos", "qvel", "act", "ctrl", "mpos", "mquat"), []
    for key in list(spec.keys):
        numbers = {field: list(getattr(key, field)) for field in fields}
        said.append({"name": key.name, "time": key.time, **numbers})
        spec.delete(key)
    return said


def _shorten_keyframes(
    spec: mujoco.MjSpec,
    plain: mujoco.MjModel,
    keyframes: Sequence[dict[str, Any]],
    joints: Sequence[int],
    motors: Sequence[int],
) -> None:
    """Restore the keyframes without the values of these joints and actuators."""
    first, states = plain.actuator_actadr, plain.actuator_actnum
    without = {
        "qpos": plain.jnt_qposadr[list(joints)].tolist(),
        "qvel": plain.jnt_dofadr[list(joints)].tolist(),
        "ctrl": motors,
        "act": [state for i in motors for state in range(first[i], first[i] + states[i])],
    }
    for keyframe in keyframes:
        key = spec.add_key()
        for field, value in keyframe.items():
            gone = without.get(field, ())
            setattr(
                key, field, [number for i, number in enumerate(value) if i not in gone] if gone else value
            )


def _fold(
    spec: mujoco.MjSpec,
    plain: mujoco.MjModel,
    index: int,
    values: Mapping[str, float],
    by_id: Mapping[int, mujoco.MjsJoint],
) -> None:
    """Fold the locked joints of a body into its pose."""
    first, count = int(plain.body_jntadr[index]), int(plain.body_jntnum[index])
    place, turn = plain.body_pos[index].copy(), plain.body_quat[index].copy()
    before: list[int] = []
    axes, points = plain.jnt_axis.copy(), plain.jnt_pos.copy()
    for joint in range(first, first + count):
        name = plain.joint(joint).name
        if name not in values:
            before.append(joint)
            continue
        if any(plain.jnt_type[other] == int(mujoco.mjtJoint.mjJNT_BALL) for other in before):
            raise BenchError(
                f"{name!r} comes after a ball joint of its body: give it a separate body in the MJCF"
            )
        moved, turned = _motion(plain, joint, values[name])
        for other in before:
            axes[other] = _rotated(axes[other], turned, back=True)
            points[other] = _rotated(points[other] - moved, turned, back=True)
        place = place + _rotated(moved, turn)
        product = np.zeros(4)
        mujoco.mju_mulQuat(product, turn, turned)
        turn = product
    body = by_id[first].parent
    if body.frame is not None:
        body.set_frame(body.parent.add_frame())
    body.pos, body.quat, body.alt.type = place, turn, mujoco.mjtOrientation.mjORIENTATION_QUAT
    for number in before:
        joint = by_id[number]
        if joint.frame is not None:
            joint.set_frame(body.add_frame())
        joint.axis, joint.pos = axes[number], points[number]
    for number in set(range(first, first + count)) - set(before):
        spec.delete(by_id[number])


def _motion(plain: mujoco.MjModel, joint: int, value: float) -> tuple[np.ndarray, np.ndarray]:
    """Translation (3,) and quaternion (4,) of the body by a joint at `value`, in the frame before the joint."""
    travel = value - float(plain.qpos0[plain.jnt_qposadr[joint]])
    axis, point = plain.jnt_axis[joint], plain.jnt_pos[joint]
    if plain.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_SLIDE):
        return travel * axis, np.array([1.0, 0.0, 0.0, 0.0])
    turned = np.zeros(4)
    mujoco.mju_axisAngle2Quat(turned, axis, travel)
    return point - _rotated(point, turned), turned


def _rotated(vector: np.ndarray, quaternion: np.ndarray, *, back: bool = False) -> np.ndarray:
    """A vector rotated by a quaternion, or by its inverse."""
    result, inverse = np.zeros(3), np.zeros(4)
    mujoco.mju_negQuat(inverse, quaternion)
    mujoco.mju_rotVecQuat(result, vector, inverse if back else quaternion)
    return result
