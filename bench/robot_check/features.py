"""MJCF features that the model lacks: refused if they would bias the result unnoticed, otherwise reported."""

from collections.abc import Iterator, Mapping
from typing import Any

import mujoco
import numpy as np

from bench.dataset.mjcf_files import read_spec, unreadable
from bench.dataset.robot import Robot
from bench.dataset.robot_drawing import CLOSED, ROUNDING, home_gap
from bench.dataset.robot_locked import locked_as_data
from bench.dataset.robot_mjcf import read_model
from bench.effects import CATALOGUE
from bench.effects.effect import MjcfTerm, Place
from bench.model.supported import label_of, unsupported_features
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.outcome import Check, CheckCode

FORCES: Mapping[MjcfTerm, tuple[str, ...]] = {  # the fields of MuJoCo's model
    "stiffness": ("jnt_stiffness", "jnt_stiffnesspoly"),
    "damping": ("dof_damping", "dof_dampingpoly"),
    "frictionloss": ("dof_frictionloss",),
    "armature": ("dof_armature",),
}
NARROW = 2.0 * np.pi  # degrees: a hinge's range within ± this may be meant in radians


def check_features(compiled: mujoco.MjModel) -> Check:
    """Whether the model can represent everything in the MJCF."""
    refused = list(unsupported_features(compiled))
    if refused:
        return Check(CheckCode.MJCF_UNSUPPORTED, "failed", {"features": refused})
    return Check(CheckCode.MJCF_SUPPORTED, "ok")


def locked_lines(robot: Robot) -> list[Check]:
    """The joints that robot.toml locks."""
    joints = locked_as_data(robot.locked)
    return [Check(CheckCode.JOINTS_LOCKED, "ok", {"joints": joints})] if joints else []


def notes(compiled: mujoco.MjModel, robot: Robot) -> list[Check]:
    """Notes on what the simulator has and the model lacks; not errors."""
    return [Check(code, "note", values) for code, values in _notes(compiled, robot)]


def _notes(compiled: mujoco.MjModel, robot: Robot) -> Iterator[tuple[CheckCode, dict[str, Any]]]:
    yield from _of_the_file(robot)
    keys = [compiled.key(key).name for key in range(compiled.nkey)]
    if keys and "home" not in keys and compiled.neq:
        yield CheckCode.KEYFRAMES_UNUSED, {"keyframes": [key for key in keys if key] or ["the first one"]}
    for index in np.flatnonzero(compiled.eq_active0 == 0).tolist():
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_EQUALITY, index)
        yield CheckCode.EQUALITY_INACTIVE, {"equality": label}
    yield from _joint_forces(compiled, robot)
    gap, unit = home_gap(robot.mjcf_as_drawn())
    if CLOSED < gap <= ROUNDING:
        yield CheckCode.DRAWING_ROUNDED, {"gap": gap, "unit": unit}
    yield from _sizes(compiled)
    if compiled.opt.density or compiled.opt.viscosity:
        medium = {"density": float(compiled.opt.density), "viscosity": float(compiled.opt.viscosity)}
        yield CheckCode.MEDIUM_NOT_MODELLED, medium
    if not compiled.opt.gravity.any():
        yield CheckCode.GRAVITY_ZERO, {}
    if compiled.nplugin:
        yield CheckCode.PLUGINS_NOT_MODELLED, {"plugins": int(compiled.nplugin)}
    if compiled.nactuator:
        yield CheckCode.ACTUATORS_UNUSED, {"actuators": int(compiled.nactuator)}
    held = compiled.eq_type == int(mujoco.mjtEq.mjEQ_TENDON)
    used = set(np.concatenate((compiled.eq_obj1id[held], compiled.eq_obj2id[held])).tolist())
    for tendon in set(range(compiled.ntendon)) - used:
        yield CheckCode.TENDON_UNUSED, {"tendon": label_of(compiled, mujoco.mjtObj.mjOBJ_TENDON, tendon)}
    if robot.tool_site is None:
        names = [compiled.site(site).name for site in range(compiled.nsite)]
        yield CheckCode.TOOL_MISSING, {"sites": [name for name in names if name]}


def _joint_forces(compiled: mujoco.MjModel, robot: Robot) -> Iterator[tuple[CheckCode, dict[str, Any]]]:
    """Springs, dampers, friction and rotors in the joints, with the effects that represent them."""
    labels = [label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, joint) for joint in range(compiled.njnt)]
    kinds = dict(zip(labels, compiled.jnt_type.tolist(), strict=True))
    for term, fields in FORCES.items():
        joints = [
            label
            for label, joint, first in zip(labels, range(compiled.njnt), compiled.jnt_dofadr, strict=True)
            if any(
                getattr(compiled, name)[joint if name.startswith("jnt_") else first].any() for name in fields
            )
        ]
        if term == "armature":  # of a driven joint it is a base parameter, or part of one
            joints = [joint for joint in joints if joint not in robot.driven]
        if not joints:
            continue
        balls, free = (
            [joint for joint in joints if kinds[joint] == int(kind)]
            for kind in (mujoco.mjtJoint.mjJNT_BALL, mujoco.mjtJoint.mjJNT_FREE)
        )
        unfitted = free if CATALOGUE[_effect_of(term, "passive")].in_balls else [*balls, *free]
        fitted = [joint for joint in joints if joint not in unfitted]
        effects = [
            f"{_effect_of(term, 'actuator' if joint in robot.driven else 'passive')}:{joint}"
            for joint in sorted(fitted, key=lambda joint: joint not in robot.driven)
        ]
        values = {"term": term, "joints": joints, "effects": effects, "unfitted": unfitted}
        values["as_a_whole"] = balls if term == "frictionloss" else []
        yield CheckCode.JOINT_FORCE_NOT_MODELLED, values


def _of_the_file(robot: Robot) -> Iterator[tuple[CheckCode, dict[str, Any]]]:
    if (left_out := unreadable(robot.model_path)).files:
        yield CheckCode.FILES_LEFT_OUT, {"files": list(left_out.files), "bodies": list(left_out.bodies)}
    if turning := _whole_turns(robot):
        yield CheckCode.RANGES_OF_A_TURN, {"joints": turning}
    if narrow := _ranges_in_degrees(robot):
        yield CheckCode.RANGES_IN_DEGREES, {"joints": narrow}


def _whole_turns(robot: Robot) -> list[str]:
    """Joints of the file whose range `Robot.mjcf_model` drops."""
    file, read = read_model(robot.model_path), robot.mjcf_model()
    endless = {read.joint(joint).name for joint in range(read.njnt) if not read.jnt_limited[joint]}
    return [
        name
        for joint in np.flatnonzero(file.jnt_limited)
        if (name := file.joint(int(joint)).name) in endless and name not in robot.driven
    ]


def _ranges_in_degrees(robot: Robot) -> list[str]:
    """All hinges with a range, if the file is in degrees but every range would be usual in radians; otherwise none."""
    spec = read_spec(robot.model_path)
    hinges = [
        joint
        for joint in spec.joints
        if joint.type == mujoco.mjtJoint.mjJNT_HINGE and joint.range[0] < joint.range[1]
    ]
    if not spec.compiler.degree or any(np.abs(joint.range).max() > NARROW for joint in hinges):
        return []
    return [joint.name for joint in hinges]


def _effect_of(term: MjcfTerm, place: Place) -> str:
    """The effect of the catalogue with the law of this MJCF term, for a joint with or without a motor."""
    return next(name for name, effect in CATALOGUE.items() if (effect.in_mjcf, effect.place) == (term, place))


def _sizes(compiled: mujoco.MjModel) -> Iterator[tuple[CheckCode, dict[str, Any]]]:
    """Lengths and masses that seem to be in other units."""
    places = np.vstack((compiled.body_pos, compiled.site_pos))  # in their parents
    if (length := float(np.linalg.norm(places, axis=1).max(initial=0.0))) > PLAUSIBLE.length:
        yield CheckCode.LENGTHS_LARGE, {"length": length}
    heavy = {
        label_of(compiled, mujoco.mjtObj.mjOBJ_BODY, int(body)): float(compiled.body_mass[body])
        for body in np.flatnonzero(compiled.body_mass > PLAUSIBLE.mass)
    }
    if heavy:
        yield CheckCode.MASSES_LARGE, {"masses": heavy}
