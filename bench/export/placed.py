"""Effects that a joint or an actuator of MuJoCo can represent, and those for `bench.twin`."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from bench.effects.laws.base_tilt import BaseTilt
from bench.export.identified import EffectValues, IdentifiedModel
from bench.export.physical import PhysicalSet
from bench.model.bounds import RANKS
from bench.model.regressor import projected_regressor
from bench.model.states import random_motion

SEED = 20121001
STATES = 40
NO_PLACE = "MuJoCo's joints and actuators have no term for it"


def tilted(gravity: np.ndarray, tilt: EffectValues) -> np.ndarray:
    """Gravity (3,) in the tilted base: Ry(-tilt_y) Rx(-tilt_x) g, see `BaseTilt`."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - slow to import, and seldom needed

    vertical = int(np.argmax(np.abs(gravity)))
    turned = gravity
    for axis, angle in (
        ((vertical + 1) % 3, tilt.values["tilt_x"]),
        ((vertical + 2) % 3, tilt.values["tilt_y"]),
    ):
        turned = Rotation.from_rotvec(-angle * np.eye(3)[axis]).apply(turned)
    return np.asarray(turned)


def still_determined(model: IdentifiedModel, gravity: np.ndarray) -> bool:
    """Whether the base parameters also determine all torques under another gravity.

    Not if it acts on masses without gravity torque before: then the choice of bodies would matter.
    """
    geometry, base = model.model.geometry, model.model.base
    other = replace(geometry, gravity=gravity)
    motion = random_motion(geometry, STATES, SEED)
    count = 10 * len(geometry.joints)
    every = np.flatnonzero(np.any(base.grouping != 0.0, axis=0))
    carried = [10 * joint + k for joint, _ in geometry.bodies for k in range(10)]
    columns = np.array(sorted({*every.tolist(), *carried}))
    whole = projected_regressor(other, motion, columns).reshape(-1, len(columns))
    kept = base.columns[base.columns < count]
    rows = projected_regressor(other, motion, kept).reshape(-1, len(kept))
    follows = rows @ base.grouping[: len(kept)][:, columns]
    size = np.linalg.norm(whole, axis=0).max()
    return bool(np.linalg.norm(whole - follows, axis=0).max() < 10.0 * RANKS.slack * size)


@dataclass
class JointTerms:
    """Terms in one joint: SI at the joint. ball: a ball joint, in each coordinate of its angular velocity.

    damping: d0 + d1 |v| + d2 v2, times v; stiffness times (q - springref) pulls back.
    """

    armature: float = 0.0
    damping: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    frictionloss: float = 0.0
    stiffness: float = 0.0
    springref: float = 0.0
    offset: float = 0.0
    """Torque or force that the motor has to overcome in any motion."""
    ball: bool = False


@dataclass(frozen=True)
class NotPlaced:
    """An effect that the file lacks, and why."""

    effect: EffectValues
    why: str


@dataclass(frozen=True)
class Placed:
    """joints: by name, every one with a motor or an effect; not_placed: what they cannot hold; gravity (3,) m/s2."""

    joints: Mapping[str, JointTerms]
    not_placed: tuple[NotPlaced, ...]
    gravity: np.ndarray


def placed_effects(physical: PhysicalSet, log: str = "") -> Placed:
    """The effects of a model and its rotors in MuJoCo's joints, if they can represent them completely.

    log: the recording whose values count if each has a separate one; else their mean.
    """
    model = physical.model
    joints = {
        joint: JointTerms(armature=float(rotor))
        for joint, rotor in zip(model.robot.joints, physical.rotors, strict=True)
    }
    balls = {joint.name for joint in model.model.geometry.joints if joint.kind == "ball"}
    not_placed = []
    gravity = model.model.geometry.gravity
    for effect in model.effects_in(log):
        if effect.name == BaseTilt.name:
            whole = isinstance(effect.instance.effect, BaseTilt)
            turned = tilted(gravity, effect) if whole else gravity
            if whole and still_determined(model, turned):
                gravity = turned
            else:
                not_placed.append(
                    NotPlaced(effect, "tilted gravity would move masses of which the data say nothing")
                )
            continue
        known = effect.name in RULES
        terms = joints.setdefault(effect.place, JointTerms(ball=effect.place in balls)) if known else None
        why = NO_PLACE if terms is None else RULES[effect.name](effect.values, terms)
        if why:
            not_placed.append(NotPlaced(effect, why))
    return Placed(joints, tuple(not_placed), gravity)


Rule = Callable[[Mapping[str, float], JointTerms], str]  # puts an effect into terms, or says why it cannot


def _damping(name: str, order: int) -> Rule:
    """A value of that name, times velocity times speed to the power `order`."""

    def rule(values: Mapping[str, float], terms: JointTerms) -> str:
        if values[name] < 0.0:
            return f"damping cannot be negative ({values[name]:.3g})"
        terms.damping[order] += values[name]
        return ""

    return rule


def _coulomb(values: Mapping[str, float], terms: JointTerms) -> str:
    if terms.ball:
        return "MuJoCo's frictionloss brakes each axis of a ball joint by itself, not its angular velocity as a whole"
    if values["Fc"] < 0.0:
        return f"frictionloss cannot be negative ({values['Fc']:.3g})"
    terms.frictionloss += values["Fc"]
    return ""


def _rotor(values: Mapping[str, float], terms: JointTerms) -> str:
    if terms.armature + values["Ia"] < 0.0:
        return f"armature cannot be negative ({terms.armature + values['Ia']:.3g})"
    terms.armature += values["Ia"]
    return ""


def _offset(values: Mapping[str, float], terms: JointTerms) -> str:
    terms.offset += values["c"]
    return ""


def _spring(values: Mapping[str, float], terms: JointTerms) -> str:
    if values["k"] <= 0.0:
        return f"stiffness must be positive ({values['k']:.3g})"
    terms.stiffness, terms.springref = values["k"], values["kq0"] / values["k"]
    return ""


RULES: dict[str, Rule] = {
    "constant_offset": _offset,
    "coulomb_friction": _coulomb,
    "joint_spring": _spring,
    "passive_coulomb_friction": _coulomb,
    "passive_rotor_inertia": _rotor,
    "passive_spring": _spring,
    "passive_viscous_friction": _damping("Fv", 0),
    "quadratic_drag": _damping("c", 1),
    "rotor_inertia": _rotor,
    "viscous_friction": _damping("Fv", 0),
}
"""Sorted by name of the effect."""


def not_placed_lines(not_placed: Iterable[NotPlaced]) -> list[str]:
    """The effects that remain, one line each, with their values."""
    lines = []
    for unplaced in not_placed:
        values = {**unplaced.effect.instance.effect.shape_values(), **unplaced.effect.values}
        listed = ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
        at = f" at {unplaced.effect.place}" if unplaced.effect.place else ""
        lines.append(f"{unplaced.effect.name}{at} ({listed}): {unplaced.why}")
    return lines
