"""What to change if motors and closures do not determine the robot's motion, as a value and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum, auto
from typing import TYPE_CHECKING

import numpy as np

from bench.basics.files.toml_output import toml_line
from bench.basics.joint_units import written_position
from bench.basics.sentence import and_list, say
from bench.dataset.joint_facts import joints_with_springs
from bench.dataset.robot_redundancy import listed, use_connect, welds_to_connect
from bench.model.bounds import CLOSURE, RANKS

if TYPE_CHECKING:
    from bench.dataset.robot import Robot
    from bench.model.geometry import Geometry, Joint


class CureCode(StrEnum):
    """What to do."""

    FIX_BASE = auto()
    REMOVE_BODY = auto()
    CLOSE_MORE = auto()
    CUT_AT_BALL = auto()
    LOCK = auto()
    LOCK_SPRINGS = auto()
    CONNECT = auto()


@dataclass(frozen=True)
class Cure:
    """names: of a body to fix or remove, of joints to lock, of welds; positions: of the joints at home, rad or m.

    others: joints that could be locked instead; stops: joints at their end stops at home that would suffice, if all
    joints to lock have springs. locks: whether robot.toml already locks joints, in a table [locked].
    """

    code: CureCode
    names: tuple[str, ...]
    positions: Mapping[str, float] = field(default_factory=dict)
    others: tuple[str, ...] = ()
    stops: tuple[str, ...] = ()
    locks: bool = False


def floating_base(geometry: Geometry) -> Cure | None:
    """The body with a free joint that carries motors, where no closure ties it to the world: a humanoid's pelvis."""
    roots = [_root(geometry.joints, index) for index in range(len(geometry.joints))]
    free = {root for root in roots if geometry.joints[root].kind == "free"}
    grounded = {-1, *(root for root in roots if root not in free)}
    ties = [
        {end.joint if end.joint < 0 else roots[end.joint] for end in (loop.first, loop.second)}
        for loop in geometry.loops
    ]
    while tied := [tie for tie in ties if tie & grounded and not tie <= grounded]:
        grounded = grounded.union(*tied)
    driven = set(geometry.robot.driven)
    for joint, root in zip(geometry.joints, roots, strict=True):
        if root not in grounded and joint.name in driven:
            body = geometry.joints[root].body
            return None if body is None else Cure(CureCode.FIX_BASE, (body,))
    return None


def what_to_do(geometry: Geometry, loose: Sequence[str], jacobian: np.ndarray, rank: int) -> Cure:
    """The cure if these joints can move while the motors are held; jacobian and rank as in `joints_to_lock`."""
    object_of_scene = _untied(geometry, loose)
    if object_of_scene is not None:
        return Cure(CureCode.REMOVE_BODY, (object_of_scene,))
    return joints_to_lock(geometry, jacobian, rank) or _rods_to_cut(geometry, loose)


def _rods_to_cut(geometry: Geometry, loose: Sequence[str]) -> Cure:
    """The welds where only balls are loose: a rod between two balls that a weld cuts is not seen as a rod."""
    kinds = {joint.kind for joint in geometry.joints if joint.name in loose}
    welds = tuple(loop.name for loop in geometry.loops if loop.kind == "weld")
    return Cure(CureCode.CUT_AT_BALL, welds) if kinds == {"ball"} and welds else Cure(CureCode.CLOSE_MORE, ())


def _untied(geometry: Geometry, loose: Sequence[str]) -> str | None:
    """A body with one of these joints, a free one, without connection to any motor: an object of the scene."""
    joints = geometry.joints
    group = [_root(joints, index) for index in range(len(joints))]
    ties = [(loop.first.joint, loop.second.joint) for loop in geometry.loops]
    ties += [(coupling.first[0][0], other) for coupling in geometry.couplings for other, _ in coupling.second]
    for first, second in ties:
        if first >= 0 and second >= 0:
            group = [group[first] if of == group[second] else of for of in group]
    moved = {of for of, joint in zip(group, joints, strict=True) if joint.name in geometry.robot.driven}
    for of, joint in zip(group, joints, strict=True):
        if joint.kind == "free" and joint.name in loose and of not in moved:
            return joint.body
    return None


def joints_to_lock(geometry: Geometry, jacobian: np.ndarray, rank: int) -> Cure | None:
    """Hinges and slides without a motor to lock, so that nothing moves while the motors are held.

    jacobian (m, p): of the closures by the passive velocities, and its rank. Joints with a spring come first: a leaf
    spring or flexure. None if only balls or free joints could be held.
    """
    _, _, motions = np.linalg.svd(jacobian, full_matrices=True)
    motions = motions[rank:]
    place = {int(velocity): column for column, velocity in enumerate(geometry.passive)}
    undriven = [
        joint
        for joint in geometry.joints
        if joint.kind in ("hinge", "slide") and joint.name not in geometry.robot.driven
    ]
    columns = {joint.name: motions[:, place[joint.v.start]] for joint in undriven if joint.v.start in place}
    moving = {
        name: column for name, column in columns.items() if np.abs(column).max(initial=0.0) > RANKS.cure
    }
    springs = [name for name in joints_with_springs(geometry.robot) if name in moving]
    chosen = _sufficient(moving, (*springs, *moving), len(motions))
    if not chosen:
        return None
    by_springs = set(chosen) <= set(springs)
    pressed = [joint.name for joint in undriven if joint.name in moving and _at_stop(geometry, joint)]
    stops = _sufficient(moving, [name for name in pressed if name not in springs], len(motions))
    home = {joint.name: float(geometry.home[joint.q.start]) + joint.offset for joint in undriven}
    return Cure(
        CureCode.LOCK_SPRINGS if by_springs else CureCode.LOCK,
        tuple(chosen),
        home,
        tuple(name for name in moving if name not in chosen),
        tuple(stops) if by_springs else (),
        bool(geometry.robot.locked),
    )


def _sufficient(moving: Mapping[str, np.ndarray], names: Sequence[str], motions: int) -> list[str]:
    """The first joints, by name, that stop all motions; empty if even all of them do not."""
    chosen: list[str] = []
    for name in dict.fromkeys(names):
        of_chosen = np.array([moving[joint] for joint in (*chosen, name)])
        sizes = np.linalg.svd(of_chosen, compute_uv=False)
        if len(sizes) > len(chosen) and sizes[-1] > RANKS.cure:
            chosen.append(name)
    return chosen if len(chosen) == motions else []


def _at_stop(geometry: Geometry, joint: Joint) -> bool:
    """Whether a joint is at an end of its range at home."""
    if joint.limits is None:
        return False
    at = float(geometry.home[joint.q.start]) + joint.offset
    return min(abs(at - end) for end in joint.limits) < CLOSURE.assembled


def welds_as_connects(geometry: Geometry, open_by: np.ndarray, closed: float) -> Cure | None:
    """The welds to make connects, if a weld is closed at home except for its orientation and blocks motors.

    open_by (m,): residual of the closures, m and rad; closed: bound for a closed one.
    """
    row, turned = 0, False
    for loop in geometry.loops:
        gap, twist = (
            np.abs(open_by[row : row + 3]).max(),
            np.abs(open_by[row + 3 : row + loop.size]).max(initial=0.0),
        )
        turned |= bool(gap <= closed < twist)
        row += loop.size
    if not turned:
        return None
    welds = welds_to_connect(geometry.robot.mjcf_model(), geometry.robot.driven)
    return Cure(CureCode.CONNECT, welds) if welds else None


def _root(joints: Sequence[Joint], index: int) -> int:
    while joints[index].parent >= 0:
        index = joints[index].parent
    return index


def joints_in_words(joints: Sequence[Joint]) -> str:
    """Joints by name, a free joint by its body: it seldom has a name in the MJCF."""
    named = [joint.name for joint in joints if joint.kind != "free"]
    bodies = [joint.body for joint in joints if joint.kind == "free" and joint.body is not None]
    parts = [f"joint{'s' if len(named) > 1 else ''} {listed(named)}"] if named else []
    if bodies:
        parts.append(f"the free joint{'s of bodies' if len(bodies) > 1 else ' of body'} {listed(bodies)}")
    return " and ".join(parts)


def no_motor_in_words(count: int) -> str:
    """End of a sentence on `count` joints: that they are not determined."""
    has, them = ("has", "it") if count == 1 else ("have", "them")
    return f"{has} no motor, and no loop closure determines {them}"


def cure_in_words(cure: Cure | None) -> str:
    """Continues the fault; "" without a cure."""
    if cure is None:
        return ""
    if cure.code == CureCode.CONNECT:
        return f"; {use_connect(cure.names)}"
    if cure.code in SENTENCES:
        return say(SENTENCES[cure.code], names=cure.names)
    held, stops = (_lock_lines(cure, names) for names in (cure.names, cure.stops))
    single = len(cure.names) == 1
    where = "under [locked] in robot.toml" if cure.locks else "by a first line of robot.toml"
    line = f"lock {'it' if single else 'them'} {where}: {held}"
    if cure.code == CureCode.LOCK_SPRINGS:
        said = f"; {'its spring is' if single else 'their springs are'} not in the model, {line}"
        pressed = f"; or, where springs press joints against their end stops: {stops}"
        return f"{said}{pressed}" if cure.stops else said
    if cure.others:
        place = where if cure.locks else "as the first line of robot.toml"
        return f"; a motor, a closure or a lock is missing, for example {place}: {held}"
    return f"; if {'it is' if single else 'they are'} held, {line}"


def _lock_lines(cure: Cure, names: Sequence[str]) -> str:
    """What robot.toml needs: a table in one line, or further lines of its table [locked]."""
    values = {name: written_position(cure.positions[name]) for name in names}
    if cure.locks:
        return " and ".join(f"`{toml_line(name, value)}`" for name, value in values.items())
    return toml_line("locked", values)


SENTENCES: Mapping[CureCode, str] = {
    CureCode.FIX_BASE: "body {names[0]!r} floats: no closure ties its free joint to the world, and it carries motors; "
    "to fix it to the world, remove its <freejoint/> from the MJCF, and its 7 numbers from the qpos of each keyframe",
    CureCode.REMOVE_BODY: "; nothing ties body {names[0]!r} to what the motors move: remove this object of the scene "
    "from the MJCF, and its 7 numbers from the qpos of each keyframe",
    CureCode.CUT_AT_BALL: "; a rod with a ball at each end that a <weld> cuts between them ({names}) spins freely: cut "
    "it at one of its balls, by a <connect>, or close what is open",
    CureCode.CLOSE_MORE: "; a closure is missing, or is a <connect>, which holds a point only, where a <weld> should "
    "hold a frame",
}


def driven_parts(robot: Robot) -> dict[str, str]:
    """What each motor drives, by name: "joint", "tendon" or "motor"."""
    return {actuator.joint: actuator.drives for actuator in robot.actuators}


def narrower_ranges(motors: Mapping[str, str]) -> str:
    """The cure where random poses within the ranges do not decide; motors: as from `driven_parts`."""
    if set(motors.values()) <= {"joint"}:
        where = "the motors' joints"
    else:
        where = and_list([range_in_words(name, drives) for name, drives in motors.items()])
    return f"write narrower ranges around home, away from singular poses, at {where}"


def range_in_words(name: str, drives: str) -> str:
    """The part of the MJCF that holds the range of a motor; an actuator has none."""
    if drives == "motor":
        return f"the joint or tendon of motor {name!r}, which robot.toml then has to name"
    return f"{drives} {name!r}"
