"""What an MJCF may hold and the model does not: refused where it bends the answer unseen, otherwise told."""

from collections.abc import Iterator

import mujoco
import numpy as np

from bench.robot import Robot
from bench.robot_check.machine import label_of
from bench.robot_check.report import Check

SUPPORTED = (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD)
COUPLING = ("stiffness", "damping", "frictionloss", "armature", "limited")
SWITCHES = {
    mujoco.mjtDisableBit.mjDSBL_GRAVITY: "gravity",
    mujoco.mjtDisableBit.mjDSBL_EQUALITY: "equality",
    mujoco.mjtDisableBit.mjDSBL_CONSTRAINT: "constraint",
}


def check_features(compiled: mujoco.MjModel) -> Check:
    """Nothing in the MJCF that the model cannot represent."""
    name = "supported MJCF"
    refused = list(_refused(compiled))
    if refused:
        more = f" (and {len(refused) - 1} more: {'; '.join(refused[1:])})" if len(refused) > 1 else ""
        return Check(name, "failed", refused[0] + more)
    return Check(name, "ok", "bodies, joints, connect and weld alone")


def notes(compiled: mujoco.MjModel, robot: Robot) -> list[Check]:
    """What the simulator adds and the model does not know; no error, but it is told."""
    return [Check("note", "note", text) for text in _notes(compiled, robot)]


def _refused(compiled: mujoco.MjModel) -> Iterator[str]:
    for flag, what in SWITCHES.items():
        if compiled.opt.disableflags & flag:
            yield f'<flag {what}="disable"/>: the model always counts on {what}'
    yield from _refused_equalities(compiled)
    for body in range(1, compiled.nbody):
        label = repr(label_of(compiled, mujoco.mjtObj.mjOBJ_BODY, body))
        if compiled.body_mocapid[body] >= 0:
            yield f"body {label} is a mocap body, which no joint moves; fix it to its parent"
        if compiled.body_gravcomp[body]:
            yield f"body {label} has gravcomp {compiled.body_gravcomp[body]:g}: the model gives bodies weight"
    for flex in range(compiled.nflex):
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_FLEX, flex)
        yield f"flex {label!r}: deformable bodies are not supported"
    for tendon in range(compiled.ntendon):
        acting = [what for what in COUPLING if np.any(getattr(compiled, f"tendon_{what}")[tendon])]
        if acting:
            label = label_of(compiled, mujoco.mjtObj.mjOBJ_TENDON, tendon)
            yield f"tendon {label!r} has {', '.join(acting)}: it couples joints, unknown to the model"


def _refused_equalities(compiled: mujoco.MjModel) -> Iterator[str]:
    for index in range(compiled.neq):
        if not compiled.eq_active0[index]:
            continue
        kind = mujoco.mjtEq(int(compiled.eq_type[index]))
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_EQUALITY, index)
        if kind not in SUPPORTED:
            yield (
                f"equality {label!r} of type {_word(kind)}{_coupled(compiled, index)}: "
                "only connect and weld close a loop"
            )
        elif kind == mujoco.mjtEq.mjEQ_WELD and compiled.eq_data[index, 10] <= 0:
            yield f"weld {label!r} has torquescale 0 and holds no rotation; use a connect"


def _notes(compiled: mujoco.MjModel, robot: Robot) -> Iterator[str]:
    for index in range(compiled.neq):
        if not compiled.eq_active0[index]:
            label = label_of(compiled, mujoco.mjtObj.mjOBJ_EQUALITY, index)
            yield f"equality {label!r} is inactive and ignored"
    forces = {
        "spring (stiffness)": ("jnt_stiffness", "jnt_stiffnesspoly"),
        "damping": ("dof_damping", "dof_dampingpoly"),
        "friction (frictionloss)": ("dof_frictionloss",),
    }
    for what, fields in forces.items():
        named = _joints_with(compiled, fields)
        if named:
            yield f"{what} on {', '.join(named)}: the simulator will add it, the model does not know it"
    rotors = [name for name in _joints_with(compiled, ("dof_armature",)) if name not in robot.joints]
    if rotors:
        yield f"rotor inertia (armature) on the passive {', '.join(rotors)}: the model does not know it"
    if compiled.opt.density or compiled.opt.viscosity:
        yield "the air (density, viscosity) slows bodies in the simulator, the model does not know it"
    if compiled.nplugin:
        yield f"{compiled.nplugin} plug-ins of MuJoCo: the model does not know what they do"
    if compiled.nactuator:
        yield f"{compiled.nactuator} actuators of the MJCF are not used: robot.toml names the motors"
    for tendon in range(compiled.ntendon):
        yield f"tendon {label_of(compiled, mujoco.mjtObj.mjOBJ_TENDON, tendon)!r} is ignored"


def _coupled(compiled: mujoco.MjModel, index: int) -> str:
    if compiled.eq_type[index] != mujoco.mjtEq.mjEQ_JOINT:
        return ""
    ids = (int(compiled.eq_obj1id[index]), int(compiled.eq_obj2id[index]))
    names = [repr(label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, joint)) for joint in ids if joint >= 0]
    return (
        f", which couples joints {' and '.join(names)}"
        if len(names) > 1
        else f", which holds joint {names[0]}"
    )


def _joints_with(compiled: mujoco.MjModel, fields: tuple[str, ...]) -> list[str]:
    names = []
    for joint in range(compiled.njnt):
        first = int(compiled.jnt_dofadr[joint])
        for field in fields:
            values = getattr(compiled, field)
            if np.any(values[joint] if field.startswith("jnt_") else values[first]):
                names.append(label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, joint))
                break
    return names


def _word(kind: mujoco.mjtEq) -> str:
    return str(kind.name).removeprefix("mjEQ_").lower()
