"""The joints and loops of an MJCF as lines of a table."""

import mujoco
import numpy as np

from bench.basics.joint_units import joint_units
from bench.dataset.robot import Robot
from bench.model.geometry import Geometry
from bench.model.supported import label_of
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.loops import gaps, loop_bodies
from bench.robot_check.machine import CheckedMachine, body_label
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.report import HomeSource, JointLine, LoopLine


def home_of(compiled: mujoco.MjModel, robot: Robot) -> tuple[np.ndarray, HomeSource]:
    """The home pose as qpos (nq,), and where it comes from."""
    key = mujoco.mj_name2id(compiled, mujoco.mjtObj.mjOBJ_KEY, "home")
    home = compiled.qpos0.copy() if key < 0 else compiled.key_qpos[key].copy()
    # MuJoCo fills up with qpos0, and does not say so
    given = next((len(drawn.qpos) for drawn in robot.mjcf_as_drawn().keys if drawn.name == "home"), None)
    return home, HomeSource(given, int(compiled.nq))


def joint_lines(compiled: mujoco.MjModel, robot: Robot) -> tuple[JointLine, ...]:
    """Every joint of the MJCF, in its order."""
    home, _ = home_of(compiled, robot)
    gains = {actuator.joint: f"{actuator.gain:g} {actuator.gain_unit}" for actuator in robot.motors}
    lines = []
    for index in range(compiled.njnt):
        name = label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, index)
        kind = mujoco.mjtJoint(int(compiled.jnt_type[index])).name.removeprefix("mjJNT_").lower()
        body = int(compiled.jnt_bodyid[index])
        scalar, limited = kind in ("hinge", "slide"), bool(compiled.jnt_limited[index])
        low, high = (float(end) for end in compiled.jnt_range[index])
        lines.append(
            JointLine(
                name=name,
                kind=kind,
                parent=body_label(compiled, int(compiled.body_parentid[body])),
                actuated=name in gains,
                gain=gains.get(name, ""),
                lower=low if scalar and limited else None,
                upper=high if scalar and limited else None,
                home=float(home[compiled.jnt_qposadr[index]]) if scalar else None,
            )
        )
    return tuple(lines)


def loop_lines(machine: CheckedMachine) -> tuple[LoopLine, ...]:
    """Every loop closure with its gap in the home pose."""
    geometry: Geometry = machine.geometry
    pairs = loop_bodies(geometry, machine.compiled)
    return tuple(
        LoopLine(loop.name, loop.kind, bodies, loop.size, *gap)
        for loop, bodies, gap in zip(geometry.loops, pairs, gaps(machine, geometry.home), strict=True)
    )


def check_home_ranges(joints: tuple[JointLine, ...]) -> Check:
    """Home lies within every joint range."""
    for joint in joints:
        if joint.home is None or joint.lower is None or joint.upper is None:
            continue
        if not joint.lower - PLAUSIBLE.end <= joint.home <= joint.upper + PLAUSIBLE.end:
            unit = joint_units(joint.kind == "hinge").position
            limits = {"lower": joint.lower, "upper": joint.upper}
            offender = {"joint": joint.name, "home": joint.home, "unit": unit, **limits}
            return Check(CheckCode.HOME_OUTSIDE_RANGE, "failed", offender)
    ranged = sum(joint.lower is not None for joint in joints)
    return Check(CheckCode.HOME_WITHIN_RANGES, "ok", {"ranged": ranged, "joints": len(joints)})
