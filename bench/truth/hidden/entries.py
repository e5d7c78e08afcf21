"""From the [[hidden]] entries of a scenario to effects."""

from collections.abc import Sequence
from dataclasses import MISSING, fields
from pathlib import Path

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.scenario.tables import Hidden
from bench.truth.hidden import HIDDEN_EFFECTS, HiddenEffect, JointEffect
from bench.truth.hidden.user_file import hidden_in


def hidden_effects(
    entries: Sequence[Hidden], actuated: Sequence[str], model: mujoco.MjModel
) -> tuple[HiddenEffect, ...]:
    """The effects of the entries, one a joint; without a joint, in all joints that can have it.

    model: the robot's; its hinges and slides that are not `actuated` are passive, and its ball joints where
    the effect can be in them.
    Raises BenchError for an effect, a joint or a parameter that does not exist, and for a missing or wrong
    parameter.
    """
    effects: list[HiddenEffect] = []
    for i, entry in enumerate(entries):
        where = f"hidden[{i}]"
        known = HIDDEN_EFFECTS if entry.file is None else hidden_in(Path(entry.file))
        if entry.effect not in known:
            of_file = "" if entry.file is None else f" in {entry.file}"
            raise BenchError(
                f"{where}.effect: no effect {entry.effect!r}{of_file}; there are {', '.join(known)}"
            )
        kind = known[entry.effect]
        parameters = _parameters(entry, kind, where)
        if issubclass(kind, JointEffect):
            joints = _joints(entry, kind, actuated, model, where)
            effects += [kind(joint=joint, **parameters) for joint in joints]
        elif entry.joint is not None:
            raise BenchError(f"{where}.joint: {entry.effect} is of the whole machine, not of a joint")
        else:
            effects.append(kind(**parameters))
    return tuple(effects)


def parameter_names(kind: type[HiddenEffect]) -> tuple[str, ...]:
    """Parameters of an effect, in their order."""
    return tuple(field.name for field in fields(kind) if field.name != "joint")


def _parameters(entry: Hidden, kind: type[HiddenEffect], where: str) -> dict[str, float]:
    names = parameter_names(kind)
    for key, value in entry.parameters.items():
        if key not in names:
            raise BenchError(f"{where}.{key}: unknown key; {entry.effect} has {', '.join(names)}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise BenchError(f"{where}.{key}: should be a number, got {value!r}")
        if not np.isfinite(value):
            raise BenchError(f"{where}.{key}: should be finite, got {value!r}")
        if value < 0 and key in kind.not_negative:
            raise BenchError(f"{where}.{key}: should be at least 0, got {value!r}")
        if value <= 0 and key in kind.positive:
            raise BenchError(f"{where}.{key}: should be greater than 0, got {value!r}")
    for field in fields(kind):
        if field.name in names and field.default is MISSING and field.name not in entry.parameters:
            raise BenchError(f"{where}.{field.name}: missing; {entry.effect} needs it")
    return {name: float(entry.parameters[name]) for name in names if name in entry.parameters}


def _joints(
    entry: Hidden, kind: type[JointEffect], actuated: Sequence[str], model: mujoco.MjModel, where: str
) -> Sequence[str]:
    kinds = [int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)]
    kinds += [int(mujoco.mjtJoint.mjJNT_BALL)] if kind.in_balls else []
    what = "hinge, slide or ball joint" if kind.in_balls else "hinge or slide joint"
    known = [model.joint(j).name for j in range(model.njnt) if model.jnt_type[j] in kinds]
    passive = [joint for joint in known if joint not in actuated]
    allowed = {"actuated": list(actuated), "passive": passive, "any": known}[kind.where]
    if entry.joint is None:
        joints = passive if kind.where == "passive" else list(actuated)
        if not all(joints):
            raise BenchError(
                f"{where}: {entry.effect}: a passive joint has no name: name the joints in the MJCF"
            )
        if not joints:
            raise BenchError(f"{where}: {entry.effect}: the robot has no passive {what}")
        return joints
    if entry.joint not in known or not entry.joint:
        raise BenchError(f"{where}.joint: no {what} {entry.joint!r}; there are {', '.join(allowed)}")
    if entry.joint not in allowed:
        has = "no motor" if kind.where == "actuated" else "a motor"
        raise BenchError(
            f"{where}.joint: {entry.effect} is not for {entry.joint!r}, which has {has}; there are"
            f" {', '.join(allowed)}"
        )
    return [entry.joint]
