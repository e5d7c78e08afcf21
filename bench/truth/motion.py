"""The closed loop, step by step: the true motion of the machine."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from mujoco.batch import Batch, SimulationError
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import one_line
from bench.basics.progress import SILENT, Progress
from bench.dataset.robot import Robot
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.assembly import assembled, holding_torque
from bench.truth.hidden.base import MOTOR_SIDE
from bench.truth.loops import POINTS, batch_gaps
from bench.truth.machine import Machine
from bench.truth.redundant import references
from bench.truth.stepping import States, Stepper

Array = NDArray[np.float64]
CHUNK = 2000  # approximate number of steps in one call, which limits the memory for any duration
KEPT = 64  # parts of motions whose reference is cached, at most 0.3 MB each for six motors
RECORD = ("qpos", "qvel", "qacc", "actuator_force", *POINTS)


@dataclass(frozen=True)
class Timing:
    """Relation of steps and samples: step in s, steps per sample, samples of settling before time 0."""

    step: float
    log_every: int
    settle: int


@dataclass(frozen=True, eq=False)
class MotionRun:
    """One motion to simulate: the payload (or None), the reference, the number of samples."""

    name: str
    payload: str | None
    trajectory: FourierTrajectory
    samples: int


@dataclass(frozen=True, eq=False)
class TrueMotion:
    """The true motion of one run at the log rate, N samples, in MuJoCo's coordinates.

    At each sample, all of these satisfy the rigid-body equations to rounding, apart from hidden effects.
    """

    time: Array
    """(N,) s, uniform from 0."""
    qpos: Array
    """(N, nq)."""
    qvel: Array
    """(N, nv)."""
    qacc: Array
    """(N, nv)."""
    torque: Array
    """(N, n) torque or force of the motors."""
    current: Array
    """(N, n) logged current reference before noise, in the drive's unit."""
    misread: Array
    """(N, n) encoder reading minus position of the motors, without constant offsets."""
    reference: Array
    """(N, n) reference positions of the actuated joints."""
    gaps: Array
    """(N, loops) gap of every loop, m."""


def simulate_motion(
    machine: Machine, runs: Sequence[MotionRun], timing: Timing, threads: int = 2, progress: Progress = SILENT
) -> tuple[TrueMotion, ...]:
    """The motion of every run, simulated in parallel; the number of threads only affects the computing time.

    A run begins at rest at the start of its trajectory with the loops closed. The controller holds it there for
    `timing.settle` samples before time 0. A shorter run is held at its end until the others finish.
    Raises BenchError if the loops do not close at the start or the simulation diverges.
    """
    # with laws, synchronising threads after every step costs more than it saves
    batch = Batch(machine.models[None], len(runs), 1 if machine.laws else max(1, min(threads, len(runs))))
    models = [machine.models[run.payload] for run in runs]
    batch.set_models(models)
    batch.qpos = np.stack([_first_pose(machine, run) for run in runs])
    stepper = Stepper(batch, machine, [(run.name, run.payload) for run in runs]) if machine.laws else None
    total = timing.settle + max(run.samples for run in runs)
    size = max(1, CHUNK // timing.log_every)
    chunks = []
    progress.phase("simulating", -(-total // size))
    for first in range(0, total, size):
        last = min(first + size, total)
        time = _times(timing, first, last)
        asked = [_reference(machine.robot, run.trajectory, timing, first, last) for run in runs]
        command = np.stack([machine.drive.command(*pair) for pair in asked])
        try:
            if stepper is None:
                states = _roll_out(batch, machine, models, command, timing.log_every)
            else:
                states = stepper.advance(time, command, timing.log_every)
        except SimulationError as error:
            raise BenchError(f"MuJoCo gave up at {time[0]:g} s: {one_line(error)}") from error
        for run, warnings in zip(runs, batch.warning, strict=True):
            if np.any(warnings):
                raise BenchError(
                    f"recording {run.name!r}: the simulation diverged between {time[0]:.3g} and"
                    f" {time[-1]:.3g} s; a smaller step or a softer controller may help"
                )
        chunks.append(states)
        progress.advance()
    return tuple(_motion(machine.robot, i, run, timing, chunks) for i, run in enumerate(runs))


def _times(timing: Timing, first: int, last: int) -> Array:
    """Times of all steps from sample `first` to `last`, s."""
    steps = np.arange(first * timing.log_every, last * timing.log_every)
    return timing.step * (steps - timing.settle * timing.log_every).astype(np.float64)


@lru_cache(maxsize=KEPT)
def _reference(
    robot: Robot, trajectory: FourierTrajectory, timing: Timing, first: int, last: int
) -> tuple[Array, ...]:
    """Positions, velocities and accelerations at these times; cached, since the machines of a sweep share them."""
    evaluated = references(robot, trajectory)(_times(timing, first, last))
    for array in evaluated:
        array.setflags(write=False)
    return evaluated


def _first_pose(machine: Machine, run: MotionRun) -> Array:
    """Initial pose with the loops closed and, in drives with a spring or play, the spring loaded by the weight."""
    model = machine.models[run.payload]
    home = np.concatenate([machine.home, np.zeros(model.nq - len(machine.home))])
    m = machine.leading
    target = run.trajectory.center - machine.drive.offset[:m]
    try:
        pose = assembled(model, home, machine.dofs[:m], target)
        if (machine.motor_addresses != machine.addresses).any():
            wound = _winding(machine, model, holding_torque(model, pose, machine.dofs[:m]))
            pose = assembled(model, home, machine.dofs[:m], target - wound)
            pose[machine.motor_addresses] = np.append(target, pose[machine.addresses[m:]])
    except BenchError as error:
        raise BenchError(f"recording {run.name!r}: {error}") from error
    return pose


def _winding(machine: Machine, model: mujoco.MjModel, torque: Array) -> Array:
    """Displacement (n,) of the motors relative to their joints that transmits a torque (n,)."""
    winding = np.zeros(len(torque))
    for i, joint in enumerate(machine.robot.joints):
        if machine.motor_addresses[i] != machine.addresses[i]:
            spring = model.tendon(MOTOR_SIDE + joint).id
            low, high = model.tendon_lengthspring[spring]
            slack = (high - low) / 2
            winding[i] = torque[i] / model.tendon_stiffness[spring] + np.sign(torque[i]) * slack
    return winding


def _roll_out(
    batch: Batch, machine: Machine, models: Sequence[mujoco.MjModel], command: Array, every: int
) -> States:
    """Simulate all steps of command (R, steps, n) in one call and keep one of `every`."""
    motors = command.shape[2]
    control = np.zeros((*command.shape[:2], batch.model.nu))
    control[:, :, :motors] = command
    before = {name: batch.bind(name).copy()[:, None] for name in ("qpos", "qvel")}
    out = batch.rollout(command.shape[1], control, record=RECORD)
    # states are recorded after their step; forces, accelerations and body positions before it
    qpos, qvel = (
        np.concatenate([before[name], out[name][:, every - 1 : -1 : every]], axis=1) for name in before
    )
    torque = out["actuator_force"][:, ::every, :motors].copy()
    current = torque / machine.drive.true_gains
    gaps = batch_gaps(models, {name: out[name][:, ::every] for name in POINTS})
    acceleration = out["qacc"][:, ::every].copy()
    return States(qpos, qvel, acceleration, torque, current, np.zeros_like(current), gaps)


def _motion(robot: Robot, index: int, run: MotionRun, timing: Timing, chunks: Sequence[States]) -> TrueMotion:
    after_settling = slice(timing.settle, timing.settle + run.samples)
    qpos, qvel, qacc, torque, current, misread, gaps = (
        np.concatenate([getattr(states, name)[index] for states in chunks])[after_settling]
        for name in ("qpos", "qvel", "qacc", "torque", "current", "misread", "gaps")
    )
    time = timing.step * timing.log_every * np.arange(run.samples, dtype=np.float64)
    reference = references(robot, run.trajectory)(time)[0]
    return TrueMotion(time, qpos, qvel, qacc, torque, current, misread, reference, gaps)
