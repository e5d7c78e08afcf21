"""A robot without loops as URDF: links with identified inertias, joints with damping and dry friction."""

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from scipy.spatial.transform import Rotation

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.export.bodies import about_center
from bench.export.mjcf import digits, in_comment
from bench.export.physical import PhysicalSet
from bench.export.placed import JointTerms, Placed, not_placed_lines, placed_effects
from bench.model.geometry import Geometry, Joint

GRAVITY = np.array([0.0, 0.0, -9.81])  # m/s2: assumed by programs that read URDF
UNLIMITED = "1e9"  # URDF needs numbers, known or not


@dataclass(frozen=True)
class Urdf:
    """text: of the file; placed: the effects in it; not_held: what URDF cannot hold, a line each."""

    text: str
    placed: Placed
    not_held: tuple[str, ...]


def urdf_text(physical: PhysicalSet) -> Urdf:
    """The URDF of a tree of hinges and slides. Raises BenchError for loops, couplings, ball and free joints.

    A link is named after its body; its frame is that of its joint. Positions count from `Joint.offset`.
    """
    geometry = physical.model.model.geometry
    _check_tree(geometry)
    placed = placed_effects(physical)
    root = ET.Element("robot", name=geometry.robot.name)
    names = [joint.body or f"{joint.name}_link" for joint in geometry.joints]
    ET.SubElement(root, "link", name="world")
    for joint, name in zip(geometry.joints, names, strict=True):
        link = ET.SubElement(root, "link", name=name)
        if joint.body in physical.bodies:
            _add_inertial(link, physical.bodies[joint.body])
    for joint, name in zip(geometry.joints, names, strict=True):
        parent = names[joint.parent] if joint.parent >= 0 else "world"
        _add_joint(root, joint, parent, name, placed.joints.get(joint.name, JointTerms()))
    not_held = (*_not_held(physical, placed), *not_placed_lines(placed.not_placed))
    for line in not_held:
        root.insert(0, ET.Comment(f" not held: {in_comment(line)} "))
    ET.indent(root)
    return Urdf('<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n", placed, not_held)


def write_urdf(path: Path, physical: PhysicalSet) -> Urdf:
    """Write it, whole or not at all."""
    urdf = urdf_text(physical)
    write_text_atomically(path, urdf.text)
    return urdf


def _check_tree(geometry: Geometry) -> None:
    closed = [loop.name for loop in geometry.loops] + [coupling.name for coupling in geometry.couplings]
    faults = [f"loops and no couplings ({name})" for name in closed]
    faults += [
        f"{joint.kind} joint ({joint.name})"
        for joint in geometry.joints
        if joint.kind not in ("hinge", "slide")
    ]
    for fault in faults:
        raise BenchError(f"robot {geometry.robot.name}: URDF has no {fault}; use mjcf")


def _add_inertial(link: ET.Element, parameters: np.ndarray) -> None:
    mass, center, inertia = about_center(parameters)
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=digits(center), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=digits(mass))
    entries = {
        f"i{a}{b}": digits(inertia["xyz".index(a), "xyz".index(b)])
        for a, b in ("xx", "xy", "xz", "yy", "yz", "zz")
    }
    ET.SubElement(inertial, "inertia", entries)


def _add_joint(root: ET.Element, joint: Joint, parent: str, child: str, terms: JointTerms) -> None:
    limits = None if joint.limits is None else [limit - joint.offset for limit in joint.limits]
    kind = "prismatic" if joint.kind == "slide" else "continuous" if limits is None else "revolute"
    element = ET.SubElement(root, "joint", name=joint.name, type=kind)
    angles = Rotation.from_matrix(joint.placement.rotation).as_euler("xyz")
    ET.SubElement(element, "origin", xyz=digits(joint.placement.translation), rpy=digits(angles))
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    ET.SubElement(element, "axis", xyz=digits(joint.axis))
    limit = ET.SubElement(element, "limit")
    if kind != "continuous":
        low, high = limits or (-float(UNLIMITED), float(UNLIMITED))
        limit.attrib.update(lower=digits(low), upper=digits(high))
    limit.attrib.update(effort=UNLIMITED, velocity=UNLIMITED)
    ET.SubElement(element, "dynamics", damping=digits(terms.damping[0]), friction=digits(terms.frictionloss))


def _not_held(physical: PhysicalSet, placed: Placed) -> list[str]:
    """What MuJoCo's joints and motors can hold and URDF's cannot."""
    robot, geometry = physical.model.robot, physical.model.model.geometry
    lines = [
        f"drive gain of {actuator.joint} = {gain:.6g} {actuator.gain_unit}"
        for actuator, gain in zip(robot.actuators, physical.model.gains, strict=True)
    ]
    for name, terms in placed.joints.items():
        entries = {
            "armature": terms.armature,
            "damping by |v|": terms.damping[1],
            "stiffness": terms.stiffness,
            "spring position": terms.springref if terms.stiffness else 0.0,
            "offset": terms.offset,
        }
        lines += [f"{what} of {name} = {value:.9g}" for what, value in entries.items() if value]
    offsets = {joint.name: joint.offset for joint in geometry.joints if joint.offset}
    lines += [f"zero of {name} is at {value:.9g} in the MJCF" for name, value in offsets.items()]
    if np.abs(placed.gravity - GRAVITY).max() > 1e-9:
        lines.append(f"gravity = {digits(placed.gravity)} m/s2")
    return lines
