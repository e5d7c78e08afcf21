"""Cures as a part of the sentence that refuses a robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from bench.dataset.robot_redundancy import listed, use_connect
from bench.model.cures import Cure, CureCode

if TYPE_CHECKING:  # geometry words its own faults with these
    from bench.model.geometry import Joint


def joints_in_words(joints: Sequence[Joint]) -> str:
    """Joints by name, a free joint by its body: it seldom has a name in the MJCF."""
    named = [joint.name for joint in joints if joint.kind != "free"]
    bodies = [joint.body for joint in joints if joint.kind == "free" and joint.body is not None]
    parts = [f"joint{'s' if len(named) > 1 else ''} {listed(named)}"] if named else []
    parts += (
        [f"the free joint{'s of bodies' if len(bodies) > 1 else ' of body'} {listed(bodies)}"]
        if bodies
        else []
    )
    return " and ".join(parts)


def no_motor_in_words(count: int) -> str:
    """That so many joints are not determined, as the end of a sentence on them."""
    has, them = ("has", "it") if count == 1 else ("have", "them")
    return f"{has} no motor, and no loop closure determines {them}"


def cure_in_words(cure: Cure | None) -> str:
    """What follows the fault; nothing where there is no cure."""
    if cure is None:
        return ""
    return SENTENCES[cure.code](cure)


def _fix_base(cure: Cure) -> str:
    return (
        f"body {cure.names[0]!r} floats: no closure ties its free joint to the world, and it carries motors; "
        "to fix it to the world, remove its <freejoint/> from the MJCF, and its 7 numbers from the qpos of "
        "each keyframe"
    )


def _remove_body(cure: Cure) -> str:
    return (
        f"; nothing ties body {cure.names[0]!r} to what the motors move: remove this object of the scene from "
        "the MJCF, and its 7 numbers from the qpos of each keyframe"
    )


def _close_more(_: Cure) -> str:
    return "; a closure is missing, or is a <connect>, which holds a point only, where a <weld> should hold a frame"


def _connect(cure: Cure) -> str:
    return f"; {use_connect(cure.names)}"


def _lock(cure: Cure) -> str:
    values = ", ".join(f"{name} = {cure.positions[name]:.10g}" for name in cure.names)
    single = len(cure.names) == 1
    line = f"lock {'it' if single else 'them'}: [locked] {values} in robot.toml"
    if cure.code == CureCode.LOCK_SPRINGS:
        return f"; {'its spring is' if single else 'their springs are'} not in the model, {line}"
    if cure.others:
        return f"; a motor, a closure or a lock is missing, for example [locked] {values} in robot.toml"
    return f"; if {'it is' if single else 'they are'} held, {line}"


SENTENCES: Mapping[CureCode, Callable[[Cure], str]] = {
    CureCode.FIX_BASE: _fix_base,
    CureCode.REMOVE_BODY: _remove_body,
    CureCode.CLOSE_MORE: _close_more,
    CureCode.LOCK: _lock,
    CureCode.LOCK_SPRINGS: _lock,
    CureCode.CONNECT: _connect,
}
