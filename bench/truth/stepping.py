"""The closed loop step by step, for machines with effects that MuJoCo does not model."""

import copy
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.truth.assembly import Indices, as_slice, live_columns
from bench.truth.balls import balls_of
from bench.truth.hidden.base import Clock, HiddenEffect, JointEffect, Law, Signals, has_law
from bench.truth.hidden.laws.passive_load_friction import FORCE
from bench.truth.loops import POINTS, batch_gaps
from bench.truth.machine import Machine

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointLaw:
    """One law for some of the actuated joints."""

    columns: slice
    """Columns of the arrays (R, n) of the actuated joints."""
    value: Law


def joint_laws(
    hidden: Sequence[HiddenEffect], name: str, signals: Signals, dofs: Indices
) -> tuple[JointLaw, ...]:
    """The laws `name` of all effects that have one; the same effect in several joints is one law.

    signals: of all actuated joints.  dofs: (n,) their velocity indices.
    """
    joints = signals.joints
    laws = []
    for group in _groups([e for e in hidden if isinstance(e, JointEffect) and has_law(e, name)], joints):
        for columns, effects in _evenly_spaced(group, joints, dofs):
            parameters = {
                field.name: np.array([getattr(effect, field.name) for effect in effects], dtype=float)
                for field in fields(effects[0])
                if field.name != "joint"
            }
            law = getattr(effects[0], name)(parameters, signals.columns(columns))
            if law is not None:
                laws.append(JointLaw(columns, law))
    return tuple(laws)


def _groups(effects: Sequence[JointEffect], joints: Sequence[str]) -> Iterator[list[JointEffect]]:
    """Groups of effects of one kind, with each joint at most once, in the order of `joints`."""
    remaining = list(effects)
    while remaining:
        group: dict[str, JointEffect] = {}
        for effect in remaining:
            if type(effect) is type(remaining[0]):
                group.setdefault(effect.joint, effect)
        remaining = [effect for effect in remaining if group.get(effect.joint) is not effect]
        yield sorted(group.values(), key=lambda effect: joints.index(effect.joint))


def _evenly_spaced(
    group: list[JointEffect], joints: Sequence[str], dofs: Indices
) -> Iterator[tuple[slice, list[JointEffect]]]:
    """The whole group if its joints and their velocities are evenly spaced, so that views suffice; else each effect
    alone.
    """
    numbers = np.array([joints.index(effect.joint) for effect in group])
    columns = as_slice(numbers)
    if columns is not None and as_slice(dofs[numbers]) is not None:
        yield columns, group
        return
    for number, effect in zip(numbers.tolist(), group, strict=True):
        yield slice(number, number + 1), [effect]


@dataclass(frozen=True, eq=False)
class BearingFriction:
    """The dry friction of one joint in R runs: its velocity index, and its size (R,) at a step."""

    dof: int
    size: Callable[[], Array]


def bearings_of(machine: Machine, batch: Batch) -> tuple[BearingFriction, ...]:
    """The friction of each joint with a `bearing_friction`, including the joint's other dry friction."""
    model = machine.models[None]
    by_joint: dict[str, list[JointEffect]] = {}
    for effect in machine.hidden:
        if isinstance(effect, JointEffect) and has_law(effect, "bearing_friction"):
            by_joint.setdefault(effect.joint, []).append(effect)
    if not by_joint:
        return ()
    readings = batch.bind("sensordata")
    bearings = []
    for joint, effects in by_joint.items():
        dof = int(model.joint(joint).dofadr[0])
        at = int(model.sensor(FORCE + joint).adr[0])
        bearings.append(
            BearingFriction(dof, _size(effects, readings[:, at : at + 2], float(model.dof_frictionloss[dof])))
        )
    return tuple(bearings)


def _size(effects: list[JointEffect], across: Array, base: float) -> Callable[[], Array]:
    """Size of a joint's friction. across: live force (R, 2) in x and y of the site, whose z is the joint's axis."""
    parameters = [
        {
            field.name: np.array([getattr(effect, field.name)])
            for field in fields(effect)
            if field.name != "joint"
        }
        for effect in effects
    ]

    def size() -> Array:
        force = np.linalg.norm(across, axis=1)[:, None]
        total = np.full(len(force), base)
        for effect, values in zip(effects, parameters, strict=True):
            added = effect.bearing_friction(values, force)
            if added is not None:
                total += added[:, 0]
        return total

    return size


@dataclass(frozen=True, eq=False)
class States:
    """Samples of all runs, (R, samples, …), all at the same times."""

    qpos: Array
    qvel: Array
    qacc: Array
    torque: Array
    current: Array
    """The logged current reference."""
    misread: Array
    """Encoder reading minus position of the motors, without constant offsets."""
    gaps: Array
    """(R, samples, loops), as from `gaps_between`."""


class _Kept:
    """Samples of live arrays (R, …), as (R, samples, …) each."""

    def __init__(self, live: Sequence[Array], samples: int) -> None:
        self._pairs = [(np.empty((len(array), samples, *array.shape[1:])), array) for array in live]

    def keep(self, sample: int) -> None:
        """Store the present values of the arrays as this sample."""
        for values, live in self._pairs:
            values[:, sample] = live

    def first(self, samples: int) -> tuple[Array, ...]:
        """The first `samples` stored samples."""
        return tuple(values[:, :samples] for values, _ in self._pairs)


class Stepper:
    """A batch of R runs of a machine with laws; the laws keep their states between calls.

    At every step, the controller computes a current reference from the encoder readings, as for a drive without
    hidden effects; the rate of encoder errors is their change since the previous step. The laws convert the reference
    to the logged current, the actual current and the torques of the motors. Then follow the opposing torques, and the
    sizes of dry friction, which MuJoCo's friction constraints apply.
    """

    def __init__(self, batch: Batch, machine: Machine, runs: Sequence[tuple[str, str | None]]) -> None:
        """runs: (R,) names of the recordings and of their payloads."""
        self._batch, self._machine = batch, machine
        self._names = tuple(name for name, _ in runs)
        # copies, since two runs with the same payload may have different friction
        self._models = [copy.copy(machine.models[payload]) for _, payload in runs]
        batch.set_models(self._models)
        qpos, qvel, self._applied = (batch.bind(name) for name in ("qpos", "qvel", "qfrc_applied"))
        self._qacc = batch.bind("qacc")
        self._points = {name: batch.bind(name) for name in POINTS}
        self._qpos, self._qvel = qpos, qvel
        joints = len(machine.dofs)
        self._control = batch.bind("ctrl")[:, :joints]
        self._refresh: list[Callable[[], object]] = []
        self._clock = Clock()
        self._reference, self._current, self._torque = (np.zeros((len(runs), joints)) for _ in range(3))
        self._position = self._live(qpos, machine.motor_addresses)
        self._velocity = self._live(qvel, machine.motor_dofs)
        self._signals = Signals(
            step=float(machine.models[None].opt.timestep),
            recordings=self._names,
            joints=machine.robot.driven,
            clock=self._clock,
            position=self._position,
            velocity=self._velocity,
            acceleration=self._live(self._qacc, machine.motor_dofs),
            current=self._current,
            torque=self._torque,
            all_torques=self._torque,
        )
        self._misread, self._misread_rate = (np.zeros((len(runs), joints)) for _ in range(2))
        self._stepped = False
        self._encoders, self._log, self._flow, self._gain, torque, dry_friction = (
            joint_laws(machine.hidden, name, self._signals, machine.motor_dofs)
            for name in ("encoder", "log", "current", "gain", "torque", "dry_friction")
        )
        self._opposing = [
            (live_columns(self._applied, machine.motor_dofs[law.columns])[0], law.value) for law in torque
        ]
        self._dry = dry_friction
        self._bearings = bearings_of(machine, batch)
        self._balls = balls_of(machine.models[None], qvel)
        self._dry_friction = np.stack([model.dof_frictionloss[machine.motor_dofs] for model in self._models])
        # arrays of the models: looking them up would take longer than a law
        self._frictions = [model.dof_frictionloss for model in self._models]
        self._friction_at = as_slice(machine.motor_dofs) or machine.motor_dofs

    def advance(self, time: Array, command: Array, every: int) -> States:
        """Simulate steps at the times (steps,) with command (R, steps, n), and keep one of `every`.

        Stops early if MuJoCo warns; see `batch.warning`.
        Raises BenchError if dry friction would be negative.
        """
        drive = self._machine.drive
        reference, current, torque = self._reference, self._current, self._torque
        references = np.moveaxis(command / drive.nominal_gains, 1, 0).copy()
        kp, kv = drive.kp / drive.nominal_gains, drive.kv / drive.nominal_gains
        scratch = np.zeros_like(reference)
        samples = -(-len(time) // every)
        before = _Kept((self._qpos, self._qvel), samples)
        after = _Kept((self._qacc, torque, reference, self._misread, *self._points.values()), samples)
        warning, sample = self._batch.warning, 0
        for k, now in enumerate(time.tolist()):
            self._clock.time = now
            for refresh in self._refresh:
                refresh()
            np.subtract(references[k], np.multiply(kp, self._position, out=scratch), out=reference)
            np.subtract(reference, np.multiply(kv, self._velocity, out=scratch), out=reference)
            if self._encoders:
                self._misreading()
                reference -= kp * self._misread + kv * self._misread_rate
            current[:] = reference
            for law in self._log:
                reference[:, law.columns] = law.value()
            for law in self._flow:
                current[:, law.columns] = law.value()
            np.multiply(current, drive.true_gains, out=torque)
            for law in self._gain:
                torque[:, law.columns] *= law.value()
            self._control[:] = torque
            self._oppose()
            keep = k % every == 0
            if self._dry or self._bearings or self._balls:
                self._set_friction(keep)
            if keep:
                before.keep(sample)
            self._batch.step()
            if keep:
                after.keep(sample)
                sample += 1
                if np.count_nonzero(warning):  # diverged: the caller reports it
                    break
        qpos, qvel = before.first(sample)
        qacc, forces, logged, misread, *points = after.first(sample)
        gaps = batch_gaps(self._models, dict(zip(self._points, points, strict=True)))
        return States(qpos, qvel, qacc, forces, logged, misread, gaps)

    def _live(self, source: Array, indices: NDArray[np.signedinteger]) -> Array:
        """Columns of source, updated at every step."""
        columns, refresh = live_columns(source, indices)
        if refresh is not None:
            self._refresh.append(refresh)
        return columns

    def _misreading(self) -> None:
        """Update the errors of the encoders, and their rate since the previous step."""
        before = self._misread.copy()
        self._misread[:] = 0.0
        for law in self._encoders:
            self._misread[:, law.columns] += law.value()
        if self._stepped:
            self._misread_rate[:] = (self._misread - before) / self._signals.step
        self._stepped = True

    def _oppose(self) -> None:
        if not self._opposing:
            return
        self._applied[:] = 0.0
        for forces, law in self._opposing:
            np.subtract(forces, law(), out=forces)

    def _set_friction(self, check: bool) -> None:
        """Set the friction constraints of each run to their size at this step."""
        size = self._dry_friction.copy()
        for law in self._dry:
            size[:, law.columns] += law.value()
        if check and size.min() < 0:
            run, joint = np.unravel_index(int(size.argmin()), size.shape)
            raise BenchError(
                f"recording {self._names[run]!r}: the dry friction of joint"
                f" {self._machine.robot.driven[joint]} would be {size.min():.3g} at {self._clock.time:.3f} s:"
                " it needs a coulomb_friction of at least this size as well"
            )
        for friction, values in zip(self._frictions, size, strict=True):
            friction[self._friction_at] = values
        for bearing in self._bearings:
            for friction, level in zip(self._frictions, bearing.size(), strict=True):
                friction[bearing.dof] = level
        if self._balls:
            for friction, level in zip(self._frictions, self._balls.size(), strict=True):
                friction[self._balls.dofs] = level
        self._batch.set_models(self._models)
