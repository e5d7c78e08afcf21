"""The closed loop, step by step: what the machine really does, before any sensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mujoco.batch import Batch, SimulationError
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.toml_input import one_line
from bench.trajectory import FourierTrajectory
from bench.truth.assembly import assembled
from bench.truth.hidden import TorqueLaw
from bench.truth.machine import Machine

Array = NDArray[np.float64]
CHUNK = 2000  # steps of one call, about: bounds the memory, whatever the duration
RECORD = ("qpos", "qvel", "qacc", "actuator_force")


@dataclass(frozen=True)
class Timing:
    """How steps become samples: step in s, steps for each sample, samples of settling before time 0."""

    step: float
    log_every: int
    settle: int


@dataclass(frozen=True, eq=False)
class Run:
    """One movement to simulate: the machine with its payload (or None), a reference, a number of samples."""

    name: str
    payload: str | None
    trajectory: FourierTrajectory
    samples: int


@dataclass(frozen=True, eq=False)
class Motion:
    """The true motion of one run at the log rate, N samples; coordinates as MuJoCo has them.

    At each sample the rigid-body equations hold to rounding between all of these, hidden effects aside.
    """

    time: Array
    """(N,) s, evenly from 0."""
    qpos: Array
    """(N, nq)."""
    qvel: Array
    """(N, nv)."""
    qacc: Array
    """(N, nv)."""
    torque: Array
    """(N, n) torque or force of the motors."""
    reference: Array
    """(N, n) reference positions of the actuated joints."""


@dataclass(frozen=True, eq=False)
class _States:
    """Samples of all runs, (R, samples, …); all of one instant."""

    qpos: Array
    qvel: Array
    qacc: Array
    torque: Array


def simulate_motion(
    machine: Machine, runs: Sequence[Run], timing: Timing, threads: int = 2
) -> tuple[Motion, ...]:
    """The motion of every run, all of them side by side; the number of threads changes nothing but the time.

    A run begins with the loops closed at the start of its trajectory, at rest, and is held there by the
    controller for `timing.settle` samples before time 0. A run that is shorter than another one is held at
    its end meanwhile.
    Raises BenchError if the loops do not close at the start or the simulation diverges.
    """
    batch = Batch(machine.models[None], len(runs), max(1, min(threads, len(runs))))
    batch.set_models([machine.models[run.payload] for run in runs])
    batch.qpos = np.stack([_first_pose(machine, run) for run in runs])
    laws = _torque_laws(machine)
    total = timing.settle + max(run.samples for run in runs)
    size = max(1, CHUNK // timing.log_every)
    chunks = []
    for first in range(0, total, size):
        steps = np.arange(first * timing.log_every, min(first + size, total) * timing.log_every)
        time = timing.step * (steps - timing.settle * timing.log_every).astype(np.float64)
        command = np.stack([machine.drive.command(*run.trajectory.evaluate(time)) for run in runs])
        try:
            if laws:
                states = _step_with_laws(batch, machine, laws, time, command, timing.log_every)
            else:
                states = _roll_out(batch, command, timing.log_every)
        except SimulationError as error:
            raise BenchError(f"MuJoCo gave up at {time[0]:g} s: {one_line(error)}") from error
        for run, warnings in zip(runs, batch.warning, strict=True):
            if np.any(warnings):
                raise BenchError(
                    f"recording {run.name!r}: the simulation diverged between {time[0]:.3g} and"
                    f" {time[-1]:.3g} s; a smaller step or a softer controller may help"
                )
        chunks.append(states)
    return tuple(_motion(i, run, timing, chunks) for i, run in enumerate(runs))


def _first_pose(machine: Machine, run: Run) -> Array:
    try:
        return assembled(machine.models[run.payload], machine.home, machine.dofs, run.trajectory.center)
    except BenchError as error:
        raise BenchError(f"recording {run.name!r}: {error}") from error


def _roll_out(batch: Batch, command: Array, every: int) -> _States:
    """Take the steps of command (R, steps, n) in one call and keep one in `every`."""
    motors = command.shape[2]
    before = {name: batch.bind(name).copy()[:, None] for name in ("qpos", "qvel")}
    out = batch.rollout(command.shape[1], _padded(batch, command), record=RECORD)
    # states are recorded after their step, forces and accelerations before it
    qpos, qvel = (
        np.concatenate([before[name], out[name][:, every - 1 : -1 : every]], axis=1) for name in before
    )
    return _States(
        qpos, qvel, out["qacc"][:, ::every].copy(), out["actuator_force"][:, ::every, :motors].copy()
    )


def _step_with_laws(
    batch: Batch,
    machine: Machine,
    laws: Sequence[tuple[int, TorqueLaw]],
    time: Array,
    command: Array,
    every: int,
) -> _States:
    """The same, with torque laws evaluated before every step."""
    model, dofs, addresses = machine.models[None], machine.dofs, machine.addresses
    places = [(model.jnt_qposadr[joint], model.jnt_dofadr[joint], law) for joint, law in laws]
    qpos, qvel, control, applied = (batch.bind(name) for name in ("qpos", "qvel", "ctrl", "qfrc_applied"))
    derived = batch.bind("qacc"), batch.bind("actuator_force")
    motor = np.zeros_like(qvel)
    padded = _padded(batch, command)
    kept: list[tuple[Array, ...]] = []
    for k, now in enumerate(time):
        control[:] = padded[:, k]
        motor[:, dofs] = machine.drive.force(command[:, k], qpos[:, addresses], qvel[:, dofs])
        applied[:] = 0.0
        for address, dof, law in places:
            applied[:, dof] -= law(now, qpos[:, address], qvel[:, dof], motor[:, dof])
        before = (qpos.copy(), qvel.copy()) if k % every == 0 else None
        batch.step()
        if before is not None:
            kept.append((*before, *(values.copy() for values in derived)))
    states = [np.stack(values, axis=1) for values in zip(*kept, strict=True)]
    return _States(states[0], states[1], states[2], states[3][:, :, : len(dofs)])


def _padded(batch: Batch, command: Array) -> Array:
    """command (R, steps, n) with zeros for the actuators behind the motors, (R, steps, nu)."""
    padded = np.zeros((*command.shape[:2], batch.model.nu))
    padded[:, :, : command.shape[2]] = command
    return padded


def _torque_laws(machine: Machine) -> list[tuple[int, TorqueLaw]]:
    """Joint number and law of every hidden effect that MuJoCo does not have itself."""
    laws = [(machine.models[None].joint(effect.joint).id, effect.torque_law()) for effect in machine.hidden]
    return [(joint, law) for joint, law in laws if law is not None]


def _motion(index: int, run: Run, timing: Timing, chunks: Sequence[_States]) -> Motion:
    own = slice(timing.settle, timing.settle + run.samples)
    qpos, qvel, qacc, torque = (
        np.concatenate([getattr(states, name)[index] for states in chunks])[own]
        for name in ("qpos", "qvel", "qacc", "torque")
    )
    time = timing.step * timing.log_every * np.arange(run.samples, dtype=np.float64)
    return Motion(time, qpos, qvel, qacc, torque, run.trajectory.evaluate(time)[0])
