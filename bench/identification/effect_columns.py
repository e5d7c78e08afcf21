"""The signals of a recording and of the present model that effects may use."""

from collections.abc import Callable, Hashable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.payload import Payload
from bench.effects import EffectInstance, JointSignals, RobotSignals
from bench.effects.checked_columns import columns_at_motors
from bench.effects.signals import UNCHANGED, AskedWithinError, Changed, JointReaction, ReactionModel
from bench.identification.effect_rows import made_of
from bench.identification.filtered import Measured
from bench.identification.layout import payload_columns
from bench.identification.perturbed_observation import change_key, perturbed_rows
from bench.identification.tolerances import TOLERANCES
from bench.model.geometry import Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import Motion, motion_of
from bench.model.reaction import (
    HeldMotion,
    bearing_of,
    bearing_rows,
    bearing_torques,
    mass_on_axis,
    with_motors_held,
)
from bench.model.regressor import payload_transform, projected_regressor, redundant_columns


def joint_reactions(
    model: IdentificationModel,
    measured: Measured,
    base: np.ndarray,
    payload: np.ndarray | None,
    redundant_torques: Callable[[], np.ndarray],
) -> ReactionModel:
    """The forces in joints of one recording.

    base (nb,): the present base parameters; payload (10,): what is carried, in the tool frame; redundant_torques:
    torque (N, r) of redundant motors. The base parameters represent all standard parameters with the same motor
    torques: a mass on a joint's axis can belong to either body.
    """
    geometry = model.geometry
    known, loads = base, np.zeros(0, dtype=int)
    if payload is not None and geometry.tool is not None:
        known, loads = (
            np.concatenate((base, payload_transform(geometry.tool) @ payload)),
            model.payload_columns,
        )
    extra = redundant_columns(geometry)

    def moving(every: int) -> HeldMotion:
        if every not in measured.held:
            tree = measured.tree.at(slice(None, None, every))
            measured.held[every] = with_motors_held(geometry, tree)
        return measured.held[every]

    @cache  # every effect that is tried asks again, with the same answer
    def joint_reaction(joint: str, every: int) -> JointReaction:
        index = geometry.joint_index(joint)
        columns = np.concatenate((model.base.columns, loads, [10 * index], extra))
        key = (index, every, columns.tobytes())
        rows = measured.reactions.get(key)
        if rows is None:
            rows = bearing_rows(bearing_of(geometry, index), moving(every), columns)
            measured.reactions.keep(key, rows)
        mass, nb = len(known), len(base)
        first = rows[:, :, :nb] @ model.guessed  # of equal bars; the forces determine the model's mass
        square = float(np.vdot(first, first))
        heavier = float(np.vdot(first, rows[:, :, :nb] @ base)) / square if square > 0.0 else 0.0
        force = rows[:, :, :mass] @ known
        if len(extra):
            force = force + np.einsum("kur,kr->ku", rows[:, :, mass + 1 :], redundant_torques()[::every])

        def by_torque(other: str) -> np.ndarray:
            second = geometry.joint_index(other)
            key = (index, every, second)
            along = measured.reactions.get(key)
            if along is None:
                along = bearing_torques(bearing_of(geometry, index), moving(every), second)
                measured.reactions.keep(key, along)
            return along

        of_mass = rows[:, :, mass].copy()  # without the other rows
        return JointReaction(force, of_mass, max(heavier, 0.0) * mass_on_axis(geometry, index)[0], by_torque)

    return joint_reaction


@dataclass(frozen=True)
class PresentModel:
    """The model about which effects are linearised.

    gains (n,) N*m or N per drive unit; base (nb,) base parameters; payloads: all ten standard parameters of each
    payload in the tool frame; declared: the known ones, the others zero; speeds (n + r,): RMS speed of every joint with
    a motor over the fitted recordings; effects: those of the model with their parameters (p,); redundant_gains (r,): of
    the redundant motors.
    """

    gains: np.ndarray
    base: np.ndarray
    payloads: Mapping[str, np.ndarray]
    declared: Mapping[str, np.ndarray]
    speeds: np.ndarray
    effects: tuple[tuple[EffectInstance, np.ndarray], ...] = ()
    redundant_gains: np.ndarray = field(default_factory=lambda: np.zeros(0))


def declared_parameters(payloads: Mapping[str, Payload]) -> dict[str, np.ndarray]:
    """The known standard parameters (10,) of every payload, zero where unknown."""
    return {name: payload_columns(payload).known for name, payload in payloads.items()}


def robot_signals(model: IdentificationModel, measured: Measured, present: PresentModel) -> RobotSignals:
    """One recording as effects see it."""
    payload = measured.recording.payload
    rate = measured.recording.rate
    kinds = {joint.name: joint.kind for joint in model.geometry.joints}

    needed_at = needed_torque(lambda: signals, present)
    time = measured.time - measured.recording.began
    joints = {
        actuator.joint: JointSignals(
            time=time,
            position=measured.position[:, j],
            velocity=measured.velocity[:, j],
            acceleration=measured.acceleration[:, j],
            current=measured.current[:, j],
            gain=float(present.gains[j]),
            speed=float(present.speeds[j]),
            rate=rate,
            band=measured.settings.band(rate),
            rotates=kinds[actuator.joint] != "slide",
            needs=partial(needed_at, j),
        )
        for j, actuator in enumerate(model.geometry.robot.actuators)
    }

    torques: dict[
        Hashable, np.ndarray
    ] = {}  # effects, and the torque that they are part of, ask for the same

    def torque(changed: Changed = UNCHANGED, every: int = 1) -> np.ndarray:
        key = change_key(changed, every)
        if key not in torques:
            torques[key] = computed_torque(changed, every)
        return torques[key]

    def computed_torque(changed: Changed, every: int) -> np.ndarray:
        columns, parameters = model.base.columns, present.base
        tool = (model.geometry if changed.geometry is None else changed.geometry).tool
        if payload is not None and tool is not None:
            columns = np.concatenate((columns, model.payload_columns))
            parameters = np.concatenate((parameters, payload_transform(tool) @ present.payloads[payload]))
        columns = np.concatenate((columns, redundant_columns(model.geometry)))
        rows = perturbed_rows(model, measured, columns, changed, every)
        redundant_torque = signals.redundant_torque[::every] if len(model.geometry.redundant) else None
        return combined_torque(rows, parameters, redundant_torque)

    def carried() -> np.ndarray:
        if payload is None:
            return np.zeros_like(measured.current)
        return _carried(model, model.geometry, measured.tree, present.declared[payload])

    mass = 0.0 if payload is None else float(present.declared[payload][0])
    in_joints = torques_in_joints(lambda: signals, present)
    log = measured.recording.log
    offsets = encoder_offsets(present.effects, log)
    signals = RobotSignals(
        joints,
        model.geometry,
        lambda: _moved(model, measured, offsets, signals),
        payload,
        mass,
        carried,
        torque,
        measured.gaps,
        joint_reactions(
            model,
            measured,
            present.base,
            None if payload is None else present.payloads[payload],
            lambda: signals.redundant_torque,
        ),
        in_joints,
        torque_at_links(lambda: signals, present),
        offsets=offsets,
        log=log,
        lasting=measured.kept,
        redundant=_redundant_signals(model, measured, present),
    )
    return signals


def needed_torque(seen: Callable[[], RobotSignals], present: PresentModel) -> Callable[[int], np.ndarray]:
    """Torque (N,), N*m or N, that the present model and its effects require of a motor (index) in a recording.

    Summed on first use. Raises AskedWithinError if one of these effects asks for it.
    """
    adding = False

    @cache
    def needed() -> np.ndarray:
        nonlocal adding
        signals = seen()
        total = np.array(signals.refined(signals.coarse.torque))  # which is what others ask for, too
        adding = True
        try:
            for instance, values in present.effects:
                if instance.effect.before_torque:
                    continue
                with suppress(AskedWithinError):  # it is made of this very torque
                    _add_torque(total, signals, instance, values)
        finally:
            adding = False
        return total

    def at(motor: int) -> np.ndarray:
        if adding:
            raise AskedWithinError
        return needed()[:, motor]

    return at


def torque_at_links(seen: Callable[[], RobotSignals], present: PresentModel) -> Callable[[], np.ndarray]:
    """Motor torques (N, n), N*m or N, for the present model's effects that act on links, in a recording."""

    @cache
    def needed() -> np.ndarray:
        signals = seen()
        total = np.zeros_like(signals.position)
        for instance, values in present.effects:
            if instance.effect.at_link or instance.effect.place != "actuator":
                _add_torque(total, signals, instance, values)
        return total

    return needed


def _add_torque(
    total: np.ndarray, signals: RobotSignals, instance: EffectInstance, values: np.ndarray
) -> None:
    """Add to `total` (N, n) the motor torques for an effect with these values; nothing if the effect raises."""
    parts = [(share, *columns_at_motors(part, signals)) for part, share in made_of(signals, instance)]
    for share, columns, motors in parts:
        total[:, motors] += columns @ (share * values)


def torques_in_joints(
    seen: Callable[[], RobotSignals], present: PresentModel
) -> Callable[[], Mapping[str, np.ndarray]]:
    """Torques (N, d) of the present model's effects in joints without a motor, by name, in a recording.

    If one of them asks for these torques, as friction that depends on the joint force does, it gets the previous
    estimate: at first zero, then the sum computed from that.
    """
    known: dict[str, np.ndarray] = {}
    asked = False

    def at() -> Mapping[str, np.ndarray]:
        nonlocal asked, known
        if not asked:
            asked = True
            for _ in range(TOLERANCES.steps.reaction_rounds):
                torques: dict[str, np.ndarray] = {}
                for instance, values in present.effects:
                    for part, share in made_of(seen(), instance):
                        columns = part.effect.in_joint(seen(), part.joint)
                        if columns is not None:
                            torques[part.joint] = torques.get(part.joint, 0.0) + columns @ (share * values)
                known = torques
        return known

    return at


def combined_torque(
    rows: np.ndarray, parameters: np.ndarray, redundant_torque: np.ndarray | None
) -> np.ndarray:
    """Torque (K, n) of rows (K, n, p + r) by parameters (p,); the last by torques (K, r) of redundant motors."""
    if redundant_torque is None:
        return np.einsum("knp,p->kn", rows, parameters)
    projected, extra = np.split(rows, [len(parameters)], axis=2)
    return np.asarray(projected @ parameters + np.einsum("knr,kr->kn", extra, redundant_torque))


def _redundant_signals(
    model: IdentificationModel, measured: Measured, present: PresentModel
) -> dict[str, JointSignals]:
    """Signals of the joints of redundant motors; the loops determine their motion."""
    geometry, rate = model.geometry, measured.recording.rate
    by_joint: dict[str, JointSignals] = {}
    for r, actuator in enumerate(geometry.robot.redundant):
        joint = geometry.joints[geometry.joint_index(actuator.joint)]
        gain, current = float(present.redundant_gains[r]), measured.redundant[:, r]
        by_joint[actuator.joint] = JointSignals(
            time=measured.time - measured.recording.began,
            position=measured.tree.q[:, joint.q.start] + joint.offset,
            velocity=measured.tree.v[:, joint.v.start],
            acceleration=measured.tree.a[:, joint.v.start],
            current=current,
            gain=gain,
            speed=float(present.speeds[len(present.gains) + r]),
            rate=rate,
            band=measured.settings.band(rate),
            rotates=joint.kind != "slide",
            needs=partial(np.multiply, gain, current),
        )
    return by_joint


def encoder_offsets(effects: Iterable[tuple[EffectInstance, np.ndarray]], log: str) -> dict[str, float]:
    """Offsets of the encoders in a recording, by joint, from effects with their parameters (p,)."""
    offsets: dict[str, float] = {}
    for instance, values in effects:
        if offset := instance.share(log) * instance.effect.position_offset(values):
            offsets[instance.joint] = offsets.get(instance.joint, 0.0) + offset
    return offsets


def _moved(
    model: IdentificationModel, measured: Measured, offsets: Mapping[str, float], seen: RobotSignals
) -> Motion:
    """The motion with these encoder offsets; as measured if the loops cannot be closed with them.

    The change is smooth and is computed at the coarse samples.
    """
    shift = np.array([offsets.get(joint, 0.0) for joint in model.geometry.robot.joints])
    if not shift.any():
        return measured.tree
    few = slice(None, None, seen.every)
    near = measured.tree.at(few)
    rates = measured.velocity[few], measured.acceleration[few]
    try:
        there = motion_of(
            model.geometry, measured.time[few], measured.position[few] - shift, *rates, near=near
        )
    except BenchError:  # out of reach, or singular: an offset that no fit will keep
        return measured.tree
    tree = measured.tree
    moved = (
        getattr(tree, name) + seen.refined(getattr(there, name) - getattr(near, name))
        for name in ("q", "v", "a", "jacobian")
    )
    return Motion(measured.time, *moved)


def _carried(
    model: IdentificationModel, geometry: Geometry, tree: Motion, parameters: np.ndarray
) -> np.ndarray:
    """Torque (N, n) of a payload's standard parameters (10,) in the tool frame; none without a tool."""
    if geometry.tool is None:
        return np.zeros((len(tree.time), len(geometry.active)))
    loads = projected_regressor(geometry, tree, model.payload_columns)
    return np.asarray(loads @ (payload_transform(geometry.tool) @ parameters))
