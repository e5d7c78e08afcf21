"""MJCF elements that the model cannot represent: refused by name."""

from collections.abc import Iterator

import mujoco
import numpy as np

from bench.dataset.locked_couplings import held_bodies

SUPPORTED = (
    mujoco.mjtEq.mjEQ_CONNECT,
    mujoco.mjtEq.mjEQ_WELD,
    mujoco.mjtEq.mjEQ_JOINT,
    mujoco.mjtEq.mjEQ_TENDON,
)
# fields of a tendon, and the attribute of the MJCF
COUPLING = {
    "stiffness": "stiffness",
    "damping": "damping",
    "frictionloss": "frictionloss",
    "armature": "armature",
    "limited": "range",
}
CLOSURES = int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD)
SWITCHES = {
    mujoco.mjtDisableBit.mjDSBL_GRAVITY: "gravity",
    mujoco.mjtDisableBit.mjDSBL_EQUALITY: "equality",
    mujoco.mjtDisableBit.mjDSBL_CONSTRAINT: "constraint",
}


def unsupported_features(compiled: mujoco.MjModel) -> Iterator[str]:
    """What would bias the answer, one line each: switches, equalities, mocap bodies, flexes, tendons."""
    for flag, what in SWITCHES.items():
        if compiled.opt.disableflags & flag:
            yield f'<flag {what}="disable"/>: the model always counts on {what}; remove it'
    yield from _equalities(compiled)
    held = _held_bodies(compiled)
    for body in range(1, compiled.nbody):
        label = repr(label_of(compiled, mujoco.mjtObj.mjOBJ_BODY, body))
        if compiled.body_mocapid[body] >= 0 and body in held:
            yield f'body {label} is a mocap body, which no joint moves, but an equality holds it: remove mocap="true"'
        if compiled.body_gravcomp[body]:
            yield (
                f"body {label} has gravcomp {compiled.body_gravcomp[body]:g}: the model gives bodies weight; "
                "remove gravcomp"
            )
    for flex in range(compiled.nflex):
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_FLEX, flex)
        yield f"flex {label!r}: deformable bodies are not supported"
    yield from _coupling_tendons(compiled)
    for tendon in range(compiled.ntendon):
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_TENDON, tendon)
        for actuator in driving(compiled, tendon):
            if not is_fixed(compiled, tendon):
                yield f"tendon {label!r} is a cable in space with motor {actuator!r} on it: cables are not supported"
            elif not any(_is_joint(compiled, name) for name in (label, actuator)):
                yield (
                    f"motor {actuator!r} drives tendon {label!r}: name it in robot.toml, as "
                    f'tendon = "{label}" (its length is the logged position) or motor = "{actuator}" (times gear)'
                )


def _coupling_tendons(compiled: mujoco.MjModel) -> Iterator[str]:
    """Tendons that act on joints by a spring, damper, friction, rotor or range, grouped by these."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for tendon in range(compiled.ntendon):
        acting = tuple(
            attribute
            for field, attribute in COUPLING.items()
            if np.any(getattr(compiled, f"tendon_{field}")[tendon])
        )
        if acting:
            label = label_of(compiled, mujoco.mjtObj.mjOBJ_TENDON, tendon)
            alike.setdefault(acting, []).append(repr(label))
    for acting, labels in alike.items():
        single = len(labels) == 1
        yield (
            f"tendon{'' if single else 's'} {', '.join(labels)} {'has' if single else 'have'} {', '.join(acting)}: "
            f"{'it couples' if single else 'they couple'} joints, unknown to the model; remove "
            f"{'it' if len(acting) == 1 else 'them'} or the tendon{'' if single else 's'} from the MJCF"
        )


def _held_bodies(compiled: mujoco.MjModel) -> set[int]:
    """Bodies held by an active equality."""
    bodies: set[int] = set()
    for index in range(compiled.neq):
        if compiled.eq_active0[index] and int(compiled.eq_type[index]) in CLOSURES:
            bodies.update(held_bodies(compiled, index))
    return bodies


def _is_joint(compiled: mujoco.MjModel, name: str) -> bool:
    return int(mujoco.mj_name2id(compiled, mujoco.mjtObj.mjOBJ_JOINT, name)) >= 0


def driving(compiled: mujoco.MjModel, tendon: int) -> list[str]:
    """The actuators of the MJCF that act on a tendon."""
    acts = compiled.actuator_trntype == int(mujoco.mjtTrn.mjTRN_TENDON)
    chosen = np.flatnonzero(acts & (compiled.actuator_trnid[:, 0] == tendon))
    return [label_of(compiled, mujoco.mjtObj.mjOBJ_ACTUATOR, int(index)) for index in chosen]


def label_of(compiled: mujoco.MjModel, kind: mujoco.mjtObj, index: int) -> str:
    """The name of a part of the MJCF, or one made of its kind and number, such as joint_3."""
    word = mujoco.mjtObj(kind).name.removeprefix("mjOBJ_").lower()
    return mujoco.mj_id2name(compiled, kind, index) or f"{word}_{index}"


def _equalities(compiled: mujoco.MjModel) -> Iterator[str]:
    for index in range(compiled.neq):
        if not compiled.eq_active0[index]:
            continue
        kind = mujoco.mjtEq(int(compiled.eq_type[index]))
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_EQUALITY, index)
        if kind not in SUPPORTED:
            word = str(kind.name).removeprefix("mjEQ_").lower()
            yield f"equality {label!r} of type {word}: only connect, weld, joint and tendon are supported"
        elif kind == mujoco.mjtEq.mjEQ_WELD and compiled.eq_data[index, 10] <= 0:
            yield f"weld {label!r} has torquescale 0 and holds no rotation; use a connect"
        elif kind == mujoco.mjtEq.mjEQ_TENDON:
            for tendon in (int(compiled.eq_obj1id[index]), int(compiled.eq_obj2id[index])):
                if tendon >= 0 and not is_fixed(compiled, tendon):
                    tendon_name = label_of(compiled, mujoco.mjtObj.mjOBJ_TENDON, tendon)
                    yield f"equality {label!r}: tendon {tendon_name!r} is a cable in space, which is not supported"


def is_fixed(compiled: mujoco.MjModel, tendon: int) -> bool:
    """Whether a tendon combines joint positions linearly, not a cable in space."""
    first = int(compiled.tendon_adr[tendon])
    wraps = compiled.wrap_type[first : first + int(compiled.tendon_num[tendon])]
    return bool((wraps == int(mujoco.mjtWrap.mjWRAP_JOINT)).all())
