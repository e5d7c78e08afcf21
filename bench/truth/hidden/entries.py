"""Convert the [[hidden]] entries of a scenario to effects."""

import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.python_file import module_name, module_of, read_source
from bench.scenario.tables import Hidden
from bench.truth.hidden import HIDDEN_EFFECTS, HiddenEffect, JointEffect


def hidden_effects(
    entries: Sequence[Hidden], actuated: Sequence[str], model: mujoco.MjModel
) -> tuple[HiddenEffect, ...]:
    """The effects of the entries, one for each joint; an entry without a joint applies to all joints that may have
    it.

    model: the robot's; its hinges and slides that are not `actuated` are passive, and so are its ball joints for
    effects that they may have.
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


PREFIX = "bench_hidden_effects_"


def hidden_in(path: Path) -> dict[str, type[HiddenEffect]]:
    """The hidden effects that a Python file defines, by name: its subclasses of HiddenEffect or JointEffect.

    The file is run. Raises BenchError that names the file and, if known, the line.
    """
    return _hidden_of(read_source(path), path)


def _hidden_of(source: str, path: Path) -> dict[str, type[HiddenEffect]]:
    name = module_name(source, path, PREFIX)
    module = sys.modules.get(name) or module_of(source, path, PREFIX)
    classes = [
        member
        for member in vars(module).values()
        if isinstance(member, type) and issubclass(member, HiddenEffect) and member.__module__ == name
    ]
    by_name = {
        kind.name: kind for kind in classes if isinstance(inspect.getattr_static(kind, "name", None), str)
    }
    if not by_name:
        raise BenchError(f"{path}: no subclass of HiddenEffect or JointEffect that has a name")
    for kind in by_name.values():
        kind.__reduce__ = _reducer(source, path)  # type: ignore[assignment, method-assign]
    return by_name


def _reducer(source: str, path: Path) -> Callable[[Any], tuple[Any, ...]]:
    """The __reduce__ of such an effect: it is pickled with the text of its file, since another process has not run
    the file.
    """

    def reduced(effect: Any) -> tuple[Any, ...]:
        values = {field.name: getattr(effect, field.name) for field in fields(effect)}
        return _restored, (source, str(path), effect.name, values)

    return reduced


def _restored(source: str, path: str, name: str, values: Mapping[str, Any]) -> HiddenEffect:
    return _hidden_of(source, Path(path))[name](**values)
