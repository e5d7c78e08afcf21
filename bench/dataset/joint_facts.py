"""What the MJCF says about the driven joints: kind, range and home."""

from dataclasses import dataclass
from typing import Literal

import mujoco

from bench.dataset.home_qpos import home_qpos
from bench.dataset.robot import TORQUE_LOGS, Robot


@dataclass(frozen=True)
class JointFacts:
    """One driven joint. `lower`, `upper` (rad or m) are None if the MJCF sets no range.

    `home` is its position (rad or m) in the keyframe `home`, else in qpos0; `in_loop`: the robot has closed loops.
    `geared`: the position is that of a motor before its gear, which may run through many turns. `logs_effort`: its
    logged currents are torques or forces. `redundant`: its motor is beyond the degrees of freedom.
    """

    name: str
    kind: Literal["hinge", "slide"]
    lower: float | None
    upper: float | None
    home: float
    in_loop: bool
    geared: bool = False
    logs_effort: bool = False
    redundant: bool = False


def joint_facts(robot: Robot) -> tuple[JointFacts, ...]:
    """The facts of each driven joint, in the order of the robot's motors, redundant ones last."""
    model = robot.mjcf_model()
    home = home_qpos(model)
    loops = (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD)
    in_loop = any(int(kind) in map(int, loops) for kind in model.eq_type)
    facts = []
    for actuator in robot.motors:
        name = actuator.joint
        joint = model.joint(name)
        limited = bool(joint.limited[0])
        facts.append(
            JointFacts(
                name,
                "hinge" if joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE else "slide",
                float(joint.range[0]) if limited else None,
                float(joint.range[1]) if limited else None,
                float(home[joint.qposadr[0]]),
                in_loop,
                actuator.drives != "joint",
                actuator.gain_unit in TORQUE_LOGS.values(),
                actuator in robot.redundant,
            )
        )
    return tuple(facts)


def joints_with_springs(robot: Robot) -> tuple[str, ...]:
    """The named joints with a stiffness in the MJCF."""
    model = robot.mjcf_model()
    stiff = (model.jnt_stiffness != 0.0) | model.jnt_stiffnesspoly.any(axis=1)
    return tuple(name for joint in stiff.nonzero()[0] if (name := model.joint(int(joint)).name))
