"""The MJCF of a robot without its locked joints, and with an added joint for every motor that is not on one joint.

A motor may drive a fixed tendon (a sum of joint positions: a belt, a differential, a coupled wrist), or act through
an actuator of the file with a gear. The logged position is then that of the motor. The robot gets a rotor for it: a
body on the base with a joint of the tendon's or actuator's name, and an equality that ties its position to the sum.
"""

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Literal

import mujoco

from bench.basics.errors import BenchError
from bench.dataset.idle_parts import release_held_tendons, release_whole_turns
from bench.dataset.mjcf_files import names_a_file, read_spec
from bench.dataset.mjcf_neutral import keep_masses, neutral
from bench.dataset.robot_drawing import take_up_rounding
from bench.dataset.robot_locked import LockedJoint, lock_joints

ROTOR = "rotor:"  # prefix of the names of bodies, tendons and equalities of such motors
MASS = 1e-6  # kg: MuJoCo requires a mass; the rotor's inertia is the armature of the tendon
INERTIA = 1e-9  # kg m2
KEPT = 32  # compiled files: a command reads the same one repeatedly
ARMATURE = 1e-6  # kg m2 or kg: of a rotor without armature in the file


@dataclass(frozen=True)
class Transmission:
    """A motor on a fixed tendon, or on the joint or tendon of an actuator of the file, gear included."""

    name: str
    kind: Literal["tendon", "motor"]
    slides: bool
    """Whether the motor's position is a length [m], and its joint a slide."""


@dataclass(frozen=True)
class RobotSetup:
    """Settings of robot.toml for an MJCF: motors that are not on one joint, locked joints, and the names of all
    driven parts; driven is None if the motors are unknown.
    """

    transmissions: tuple[Transmission, ...] = ()
    locked: tuple[LockedJoint, ...] = ()
    driven: tuple[str, ...] | None = None


AS_IT_IS = RobotSetup()


def robot_model(path: Path, setup: RobotSetup = AS_IT_IS) -> mujoco.MjModel:
    """The compiled file with the rotors, without the locked joints.

    Raises ValueError if MuJoCo refuses the file, BenchError for an invalid motor or locked joint.
    """
    try:
        content = path.read_bytes()
    except OSError:
        return _compiled(path, setup)  # MuJoCo's error names the cause
    if b"file" in content:  # it refers to other files, which may change as well
        return _compiled(path, setup)
    return copy.copy(_of_content(_Content(path, content), setup))


@dataclass(frozen=True)
class _Content:
    """The content of a file that refers to no other; its path does not matter."""

    path: Path = field(compare=False)
    content: bytes


@lru_cache(maxsize=KEPT)
def _of_content(file: _Content, setup: RobotSetup) -> mujoco.MjModel:
    return _compiled(file.path, setup)


def _compiled(path: Path, setup: RobotSetup) -> mujoco.MjModel:
    model = read_model(path)
    if setup.transmissions or setup.locked or model.neq:
        model = robot_spec(path, setup).compile()
    model.opt.enableflags = 0  # sleep, contact options: unneeded, and some equalities forbid them
    return model


def read_model(path: Path) -> mujoco.MjModel:
    """The compiled file as it is, without shapes from files that cannot be read. Raises as `robot_model` does."""
    try:
        return mujoco.MjModel.from_xml_path(str(path))  # its messages name the line
    except ValueError as error:
        if not names_a_file(str(error)):
            raise
    return read_spec(path).compile()


def robot_spec(path: Path, setup: RobotSetup = AS_IT_IS) -> mujoco.MjSpec:
    """The file before compilation, with rounding errors of the drawing corrected, see `take_up_rounding`."""
    return take_up_rounding(drawn_spec(path, setup))


def drawn_spec(path: Path, setup: RobotSetup = AS_IT_IS) -> mujoco.MjSpec:
    """The same without that correction; parts as in `bench.dataset.idle_parts` are released."""
    spec = read_spec(path)
    of_locked = lock_joints(spec, setup.locked) if setup.locked else {}
    release_held_tendons(spec)
    sums: list[_Length] = []
    if setup.transmissions:
        keep_masses(spec)
        plain = spec.copy().compile()
        sums = [_length_of(plain, transmission, of_locked) for transmission in setup.transmissions]
    if setup.driven is not None:
        release_whole_turns(spec, {*setup.driven, *(name for length in sums for name, _, _ in length.joints)})
    if not sums:
        return spec
    added = [[length.at(qpos) for length in sums] for qpos in plain.key_qpos]
    for transmission, length in zip(setup.transmissions, sums, strict=True):
        _add_rotor(spec, plain, transmission, length)
    for key, qpos, lengths in zip(spec.keys, plain.key_qpos, added, strict=True):
        key.qpos = [*qpos.tolist(), *lengths]
        if len(key.qvel):
            key.qvel = [*key.qvel, *(0.0 for _ in lengths)]
    return spec


@dataclass(frozen=True)
class _Length:
    """The position of a motor: (name, index in qpos, factor) of each joint, and the constant of locked joints."""

    joints: tuple[tuple[str, int, float], ...]
    constant: float = 0.0

    def at(self, qpos: Sequence[float]) -> float:
        return self.constant + float(sum(factor * qpos[place] for _, place, factor in self.joints))


def _add_rotor(
    spec: mujoco.MjSpec, plain: mujoco.MjModel, transmission: Transmission, length: _Length
) -> None:
    if mujoco.mj_name2id(plain, mujoco.mjtObj.mjOBJ_JOINT, transmission.name) >= 0:
        raise BenchError(
            f"{transmission.kind} {transmission.name!r}: there is a joint of this name too, give it another"
        )
    body = spec.worldbody.add_body(name=ROTOR + transmission.name, mass=MASS, inertia=[INERTIA] * 3)
    body.explicitinertial = True
    kind = mujoco.mjtJoint.mjJNT_SLIDE if transmission.slides else mujoco.mjtJoint.mjJNT_HINGE
    joint = body.add_joint(
        neutral(), name=transmission.name, type=kind, axis=_axis(plain, transmission.slides)
    )
    unit = math.degrees(1.0) if spec.compiler.degree and not transmission.slides else 1.0  # of ref and range
    joint.ref = unit * length.at(plain.qpos0)
    joint.armature = ARMATURE
    sums = spec.tendon(transmission.name) if transmission.kind == "tendon" else None
    if sums is None:
        sums = spec.add_tendon(neutral(), name=f"{ROTOR}{transmission.name}:sum")
        for name, _, factor in length.joints:
            sums.wrap_joint(name, factor)
    else:
        tendon = plain.tendon(transmission.name).id
        joint.armature = float(plain.tendon_armature[tendon]) or ARMATURE
        if plain.tendon_limited[tendon]:
            joint.limited, joint.range = True, (unit * plain.tendon_range[tendon]).tolist()
        sums.armature, sums.limited = 0.0, False
    name, kind = ROTOR + transmission.name, mujoco.mjtEq.mjEQ_TENDON
    spec.add_tendon(neutral(), name=name).wrap_joint(transmission.name, 1.0)
    held = spec.add_equality(neutral(), name=name, type=kind, name1=name, name2=sums.name)
    held.data[:5] = [0.0, 1.0, 0.0, 0.0, 0.0]


def joints_of(plain: mujoco.MjModel, transmission: Transmission) -> tuple[str, ...]:
    """The joints whose positions make up that of a motor. Raises BenchError for a motor that the file does not have."""
    return tuple(name for name, _, _ in _length_of(plain, transmission, {}).joints)


def _length_of(plain: mujoco.MjModel, transmission: Transmission, lengths: Mapping[str, float]) -> _Length:
    """lengths: contribution of locked joints to the length of each tendon, by name."""
    gear = 1.0
    if transmission.kind == "tendon":
        tendon = mujoco.mj_name2id(plain, mujoco.mjtObj.mjOBJ_TENDON, transmission.name)
        if tendon < 0:
            raise BenchError(
                f"no tendon {transmission.name!r}; {_known(plain, mujoco.mjtObj.mjOBJ_TENDON, plain.ntendon)}"
            )
    else:
        motor = mujoco.mj_name2id(plain, mujoco.mjtObj.mjOBJ_ACTUATOR, transmission.name)
        if motor < 0:
            known = _known(plain, mujoco.mjtObj.mjOBJ_ACTUATOR, plain.nu)
            raise BenchError(f"no actuator {transmission.name!r}; {known}")
        gear, kind = float(plain.actuator_gear[motor, 0]), int(plain.actuator_trntype[motor])
        tendon = int(plain.actuator_trnid[motor, 0])
        if kind == int(mujoco.mjtTrn.mjTRN_JOINT):
            return _Length((_factor(plain, tendon, gear),))
        if kind != int(mujoco.mjtTrn.mjTRN_TENDON):
            raise BenchError(f"actuator {transmission.name!r} drives neither a joint nor a tendon")
    first = int(plain.tendon_adr[tendon])
    wraps = range(first, first + int(plain.tendon_num[tendon]))
    if any(int(plain.wrap_type[wrap]) != int(mujoco.mjtWrap.mjWRAP_JOINT) for wrap in wraps):
        raise BenchError(
            f"{transmission.kind} {transmission.name!r} is a cable in space: cables are not supported"
        )
    joints = (
        _factor(plain, int(plain.wrap_objid[wrap]), gear * float(plain.wrap_prm[wrap])) for wrap in wraps
    )
    return _Length(tuple(joints), gear * lengths.get(plain.tendon(tendon).name, 0.0))


def _factor(plain: mujoco.MjModel, joint: int, factor: float) -> tuple[str, int, float]:
    return plain.joint(joint).name, int(plain.jnt_qposadr[joint]), factor


def _axis(plain: mujoco.MjModel, slides: bool) -> list[float]:
    """Parallel to gravity for a hinge, perpendicular for a slide, so that gravity does not act on a rotor."""
    x, y, z = plain.opt.gravity.tolist()
    size = (x * x + y * y + z * z) ** 0.5
    along = [x / size, y / size, z / size] if size else [0.0, 0.0, 1.0]
    if not slides:
        return along
    least = min(range(3), key=lambda i: abs(along[i]))
    return [float(i == least) - along[least] * along[i] for i in range(3)]


def _known(plain: mujoco.MjModel, kind: mujoco.mjtObj, count: int) -> str:
    names = [name for i in range(count) if (name := mujoco.mj_id2name(plain, kind, i))]
    return f"the MJCF has {', '.join(names) or 'none with a name'}"
