"""Effects that the simulated machine can have and that its log does not tell, one file each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields

import mujoco
import numpy as np

from bench.errors import BenchError
from bench.scenario_tables import Hidden
from bench.truth.hidden.asymmetric_viscous_friction import AsymmetricViscousFriction
from bench.truth.hidden.base import HiddenEffect, TorqueLaw
from bench.truth.hidden.constant_offset import ConstantOffset
from bench.truth.hidden.coulomb_friction import CoulombFriction
from bench.truth.hidden.viscous_friction import ViscousFriction

__all__ = ["HIDDEN_EFFECTS", "HiddenEffect", "TorqueLaw", "hidden_effects"]

HIDDEN_EFFECTS: Mapping[str, type[HiddenEffect]] = {
    "asymmetric_viscous_friction": AsymmetricViscousFriction,
    "constant_offset": ConstantOffset,
    "coulomb_friction": CoulombFriction,
    "viscous_friction": ViscousFriction,
}
"""Every effect by the name that a scenario uses."""


def hidden_effects(
    entries: Sequence[Hidden], actuated: Sequence[str], model: mujoco.MjModel
) -> tuple[HiddenEffect, ...]:
    """The effects of a scenario's [[hidden]] entries, one a joint; without a joint, in all `actuated`.

    Raises BenchError for an effect, a joint or a parameter that does not exist, and for a missing or wrong
    parameter.
    """
    effects: list[HiddenEffect] = []
    for i, entry in enumerate(entries):
        where = f"hidden[{i}]"
        if entry.effect not in HIDDEN_EFFECTS:
            raise BenchError(
                f"{where}.effect: no effect {entry.effect!r}; there are {', '.join(HIDDEN_EFFECTS)}"
            )
        kind = HIDDEN_EFFECTS[entry.effect]
        parameters = _parameters(entry, kind, where)
        for joint in actuated if entry.joint is None else (entry.joint,):
            _check_joint(joint, model, where)
            effects.append(kind(joint, **parameters))
    return tuple(effects)


def _parameters(entry: Hidden, kind: type[HiddenEffect], where: str) -> dict[str, float]:
    names = [field.name for field in fields(kind) if field.name != "joint"]
    for key, value in entry.parameters.items():
        if key not in names:
            raise BenchError(f"{where}.{key}: unknown key; {entry.effect} has {', '.join(names)}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise BenchError(f"{where}.{key}: should be a number, got {value!r}")
        if not np.isfinite(value) or (value < 0 and key in kind.not_negative):
            raise BenchError(f"{where}.{key}: should be finite and at least 0, got {value!r}")
    for name in names:
        if name not in entry.parameters:
            raise BenchError(f"{where}.{name}: missing; {entry.effect} needs it")
    return {name: float(entry.parameters[name]) for name in names}


def _check_joint(joint: str, model: mujoco.MjModel, where: str) -> None:
    scalar = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    names = [model.joint(j).name for j in range(model.njnt) if model.jnt_type[j] in scalar]
    if joint not in names:
        raise BenchError(f"{where}.joint: no hinge or slide joint {joint!r}; there are {', '.join(names)}")
