"""The user's MJCF with identified values filled in; everything else is unchanged."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.dataset.mjcf_neutral import neutral
from bench.dataset.robot_locked import locked_in_words
from bench.dataset.robot_mjcf import INERTIA, MASS, ROTOR
from bench.export.bodies import about_center
from bench.export.identified import unknown_payload
from bench.export.physical import PhysicalSet
from bench.export.placed import JointTerms, Placed, not_placed_lines, placed_effects
from bench.identification.layout import payload_columns
from bench.model.geometry import Placement
from bench.twin.file import STEPS_TO_STICK, STIFF

PAYLOAD = "payload:"  # what the name of a payload's body begins with
LOADS = ("damping", "frictionloss", "stiffness", "armature")  # of a joint


@dataclass(frozen=True)
class DrivenJoint:
    """A motor: N*m or N per unit of current at its joint, and its load in addition to the motion, N*m or N."""

    joint: str
    gain: float
    offset: float


def set_motors(
    spec: mujoco.MjSpec, compiled: mujoco.MjModel, driven: Sequence[DrivenJoint], changed: list[str]
) -> list[mujoco.MjsActuator]:
    """One motor per joint: the file's if it has one, else a new one.

    A torque at the joint is gain times control, less the offset. Limits of control and keyframes keep their torque; a
    servo becomes a motor. changed: for messages. Returns the motors in the order of the joints.
    """
    motors = []
    for driven_joint in driven:
        for other in _on_same_part(spec, driven_joint.joint):
            changed.append(
                f"actuator {other.name!r} is gone: the motor at joint {driven_joint.joint} replaces it"
            )
            spec.delete(other)
        existing = [
            actuator
            for actuator in spec.actuators
            if actuator.target == driven_joint.joint and actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT
        ]
        if not existing:
            motors.append(
                spec.add_actuator(
                    neutral(), name=_free_name(spec, driven_joint.joint), target=driven_joint.joint
                )
            )
            _fill(motors[-1], driven_joint, 1.0)
            continue
        motor, *others = existing
        for other in others:
            changed.append(
                f"actuator {other.name!r} is gone: {motor.name!r} drives joint {driven_joint.joint} too"
            )
            spec.delete(other)
        _refill(motor, compiled, driven_joint, changed)
        motor.name = motor.name or _free_name(spec, driven_joint.joint)
        motors.append(motor)
    for key in spec.keys:
        if len(key.ctrl):
            changed.append(f"keyframe {key.name!r}: its controls are gone, they had other units")
            key.ctrl = []
        if len(key.act):
            key.act = []
    return motors


def _on_same_part(spec: mujoco.MjSpec, joint: str) -> list[mujoco.MjsActuator]:
    """Actuators of the file on the tendon of a motor, or the actuator that is the motor, where the motor has a joint of
    its own.
    """
    if spec.body(ROTOR + joint) is None:
        return []
    return [
        actuator
        for actuator in spec.actuators
        if (actuator.trntype == mujoco.mjtTrn.mjTRN_TENDON and actuator.target == joint)
        or actuator.name == joint
    ]


def _refill(
    motor: mujoco.MjsActuator, compiled: mujoco.MjModel, driven: DrivenJoint, changed: list[str]
) -> None:
    """An actuator of the file with the identified gain; its limits keep their torque."""
    place, gear = motor.id, float(motor.gear[0])
    plain = (
        compiled.actuator_gaintype[place] == int(mujoco.mjtGain.mjGAIN_FIXED)
        and compiled.actuator_biastype[place] == int(mujoco.mjtBias.mjBIAS_NONE)
        and compiled.actuator_dyntype[place] == int(mujoco.mjtDyn.mjDYN_NONE)
    )
    limits = compiled.actuator_ctrlrange[place].copy()
    limited = bool(compiled.actuator_ctrllimited[place])
    before = float(compiled.actuator_gainprm[place, 0])
    if not plain:
        changed.append(f"actuator {motor.name!r} is a motor now, its control a current: the file had a servo")
    _fill(motor, driven, gear)
    motor.ctrllimited = limited and plain
    motor.ctrlrange = np.sort(limits * before * gear / driven.gain) if limited and plain else [0.0, 0.0]


def _fill(motor: mujoco.MjsActuator, driven: DrivenJoint, gear: float) -> None:
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    motor.dyntype = mujoco.mjtDyn.mjDYN_NONE
    motor.gaintype, motor.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
    gains, biases = np.zeros(len(motor.gainprm)), np.zeros(len(motor.biasprm))
    gains[0], biases[0] = driven.gain / gear, -driven.offset / gear
    motor.gainprm, motor.biasprm = gains, biases
    motor.ctrllimited = False


def _free_name(spec: mujoco.MjSpec, joint: str) -> str:
    taken = {actuator.name for actuator in spec.actuators}
    return joint if joint not in taken else f"motor:{joint}"


@dataclass(frozen=True)
class Exported:
    """text: of the MJCF; placed: the effects in it; changed: replaced parts of the file, a line each.

    actuators: names of the motors, in the order of the robot's.
    """

    text: str
    actuators: tuple[str, ...]
    placed: Placed
    changed: tuple[str, ...]


def mjcf_text(physical: PhysicalSet, folder: Path, payload: str | None = None, log: str = "") -> Exported:
    """Masses, inertias, armature, damping, dry friction, springs and drive gains in the robot's MJCF.

    A motor's control is its current reference, in the drive's unit. folder: of the future file, relative to which it
    finds its meshes; payload: name of the one fixed at the tool; log: as in `placed_effects`. Filled-in numbers have
    all digits, the others the six that MuJoCo writes. Raises BenchError if MuJoCo refuses the result.
    """
    robot = physical.model.robot
    spec, compiled = robot.mjcf_spec(), robot.mjcf_model()
    _name_all(spec)
    _find_files_from(spec, robot.model_path.parent, folder)
    placed = placed_effects(physical, log)
    changed = [f"locked joints are fixed: {locked_in_words(robot.locked)}"] if robot.locked else []
    exact: dict[str, dict[str, str]] = {}
    spec.option.gravity = placed.gravity
    _set_bodies(spec, physical, exact, changed)
    _set_joints(spec, compiled, placed, exact, changed)
    if payload is not None:
        _add_payload(spec, physical, payload, exact)
    driven = [
        DrivenJoint(joint, float(gain), placed.joints[joint].offset)
        for joint, gain in zip(robot.joints, physical.model.gains, strict=True)
    ]
    motors = set_motors(spec, compiled, driven, changed)
    for motor in motors:
        numbers = {"gainprm": digits(motor.gainprm[0]), "biasprm": digits(motor.biasprm[0])}
        exact[f"actuator {motor.name}"] = numbers
    exact |= {
        f"key {key.name}": {"qpos": digits(qpos)}
        for key, qpos in zip(spec.keys, compiled.key_qpos, strict=True)
    }
    spec.comment = _comment(physical, placed)
    try:
        spec.compile()
        text = _with_all_digits(spec.to_xml(), exact)
    except (ValueError, mujoco.FatalError) as error:
        raise BenchError(
            f"{robot.model_path}: MuJoCo refuses the result: {' '.join(str(error).split())}"
        ) from None
    return Exported(text, tuple(motor.name for motor in motors), placed, tuple(changed))


def write_mjcf(path: Path, physical: PhysicalSet, payload: str | None = None, log: str = "") -> Exported:
    """Write it, whole or not at all, after MuJoCo has read it back from its folder."""
    exported = mjcf_text(physical, path.resolve().parent, payload, log)
    with atomic_path(path) as partial:
        partial.write_text(exported.text, encoding="utf-8")
        try:
            mujoco.MjModel.from_xml_path(str(partial))
        except ValueError as error:
            raise BenchError(f"{path}: MuJoCo refuses the result: {' '.join(str(error).split())}") from None
    return exported


def _name_all(spec: mujoco.MjSpec) -> None:
    """Names of `bench.model.geometry` for unnamed bodies and joints."""
    spec.compile()  # gives every element its number
    for body in spec.bodies:
        body.name = body.name or f"body_{body.id}"
    for joint in spec.joints:
        joint.name = joint.name or f"joint_{joint.id}"


def _find_files_from(spec: mujoco.MjSpec, source: Path, folder: Path) -> None:
    """Meshes and textures stay next to the robot's file."""
    for kind, listed in (
        ("meshdir", (*spec.meshes, *spec.hfields, *spec.skins)),
        ("texturedir", spec.textures),
    ):
        if any(entry.file for entry in listed):
            setattr(spec.compiler, kind, os.path.relpath(source / getattr(spec.compiler, kind), folder))


def _set_bodies(
    spec: mujoco.MjSpec, physical: PhysicalSet, exact: dict[str, dict[str, str]], changed: list[str]
) -> None:
    compiler = spec.compiler
    for name, off in (
        ("balanceinertia", False),
        ("boundmass", 0.0),
        ("boundinertia", 0.0),
        ("settotalmass", -1.0),
    ):
        if getattr(compiler, name) != off:
            changed.append(f"compiler {name} is off: it would change the identified masses")
            setattr(compiler, name, off)
    compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO
    frames = physical.model.model.geometry.body_frames
    carried = {joint for joint, _ in physical.model.model.geometry.bodies}
    for body in spec.bodies:
        if body.name == "world":
            continue
        if body.name.startswith(ROTOR):  # MuJoCo does not write so small a mass by itself
            inertia = [INERTIA] * 3 + [0.0] * 3
            exact[f"body {body.name}"] = {
                "mass": digits(MASS),
                "pos": "0 0 0",
                "fullinertia": digits(inertia),
            }
            continue
        joint, place = frames[body.name]
        if body.name in physical.bodies:
            _set_inertia(body, physical.bodies[body.name], place.inverse(), exact)
        elif joint in carried:
            changed.append(f"body {body.name} has no mass: it is part of its parent body")
            _set_inertia(body, np.zeros(10), place, exact)


def _set_inertia(
    body: mujoco.MjsBody, parameters: np.ndarray, place: Placement, exact: dict[str, dict[str, str]]
) -> None:
    """parameters: standard ones, in a frame with this pose in the body's."""
    mass, center, inertia = about_center(parameters)
    center = place.rotation @ center + (place.translation if mass else 0.0)
    inertia = place.rotation @ inertia @ place.rotation.T
    body.explicitinertial = True
    body.mass, body.ipos = mass, center
    full = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    body.inertia, body.iquat = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])  # MuJoCo wants one of the two
    body.ialt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    body.fullinertia = full if mass else np.full(6, np.nan)
    if mass:
        entries = {"mass": digits(mass), "pos": digits(center), "fullinertia": digits(full)}
        exact[f"body {body.name}"] = entries


def _set_joints(
    spec: mujoco.MjSpec,
    compiled: mujoco.MjModel,
    placed: Placed,
    exact: dict[str, dict[str, str]],
    changed: list[str],
) -> None:
    kinds = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
    step = float(compiled.opt.timestep)
    for joint in spec.joints:
        terms = placed.joints.get(joint.name, JointTerms())
        _tell_replaced(joint, compiled, terms, changed)
        degrees = 180.0 / math.pi if spec.compiler.degree and joint.type == kinds[0] else 1.0
        joint.armature = terms.armature
        joint.damping = terms.damping
        joint.frictionloss = terms.frictionloss
        joint.stiffness = [terms.stiffness, 0.0, 0.0]
        if joint.type in kinds:
            joint.springref = degrees * terms.springref
            joint.springdamper = [0.0, 0.0]
        exact[f"joint {joint.name}"] = {name: digits(getattr(terms, name)) for name in (*LOADS, "springref")}
        if terms.frictionloss:
            joint.solref_friction = [STEPS_TO_STICK * step, 1.0]
            joint.solimp_friction = STIFF


def _tell_replaced(
    joint: mujoco.MjsJoint, compiled: mujoco.MjModel, terms: JointTerms, changed: list[str]
) -> None:
    """What the file has of a joint and the model has not."""
    before = compiled.joint(joint.id)
    changed += [
        f"joint {joint.name}: {name} {value:.6g} of the file is gone: the identified model has none there"
        for name in LOADS
        if (value := float(getattr(before, name)[0])) and not np.any(getattr(terms, name))
    ]


def _add_payload(
    spec: mujoco.MjSpec, physical: PhysicalSet, payload: str, exact: dict[str, dict[str, str]]
) -> None:
    model = physical.model
    site = spec.site(model.robot.tool_site) if model.robot.tool_site else None
    if site is None:
        raise BenchError(f"robot {model.robot.name}: a payload needs [tool] site in robot.toml")
    parameters = physical.payloads.get(payload)
    if parameters is None and payload in model.declared:
        columns = payload_columns(model.declared[payload])
        parameters = columns.known if not len(columns.unknown) else None
    if parameters is None:
        raise unknown_payload(model, payload)
    body = site.parent.add_body(name=PAYLOAD + payload, pos=site.pos, quat=site.quat)
    _set_inertia(body, parameters, Placement(np.eye(3), np.zeros(3)), exact)


def _comment(physical: PhysicalSet, placed: Placed) -> str:
    """The comment at the head of the file."""
    model = physical.model
    lines = [
        f"Identified: {model.path.name}, robot {model.robot.name}.",
        "The control of a motor is its current reference: "
        + ", ".join(f"{actuator.joint} {actuator.gain_unit}" for actuator in model.robot.actuators),
        f"Bodies: real ones with the identified base parameters, otherwise near {physical.prior}.",
    ]
    if placed.not_placed:
        lines += [
            "Not in this file, see bench.twin:",
            *(f"  {line}" for line in not_placed_lines(placed.not_placed)),
        ]
    return in_comment("\n  ".join(lines))


def _with_digits(element: ET.Element, entries: Mapping[str, str]) -> None:
    element.attrib.update({name: value for name, value in entries.items() if name in element.attrib})


def _with_all_digits(text: str, exact: Mapping[str, Mapping[str, str]]) -> str:
    """MuJoCo's XML with all digits of these attributes, if it wrote them."""
    parser = ET.XMLParser(target=ET.TreeBuilder(insert_comments=True))
    root = ET.fromstring(text, parser=parser)
    for body in root.iter("body"):
        inertial, entries = body.find("inertial"), exact.get(f"body {body.get('name')}")
        if entries is not None:
            if inertial is None:
                inertial = ET.Element("inertial")
                body.insert(0, inertial)
            for name in ("quat", "diaginertia"):
                inertial.attrib.pop(name, None)
            inertial.attrib.update(entries)
        for joint in body.findall("joint"):
            _with_digits(joint, exact.get(f"joint {joint.get('name')}", {}))
    for kind in ("actuator", "keyframe"):
        for element in root.findall(f"{kind}/*"):
            what = "key" if kind == "keyframe" else kind
            _with_digits(element, exact.get(f"{what} {element.get('name')}", {}))
    return ET.tostring(root, encoding="unicode") + "\n"


def in_comment(text: str) -> str:
    """The text for a comment in XML, which must not have two hyphens in a row."""
    return text.replace("--", "- -")


def digits(values: float | np.ndarray | Sequence[float]) -> str:
    """Numbers for an attribute in XML, with all digits."""
    return " ".join(repr(float(value)) for value in np.atleast_1d(values))
