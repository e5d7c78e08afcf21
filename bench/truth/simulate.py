"""Simulate a scenario: the true motions and their logs."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.basics.joint_units import HINGE, SLIDE, units_of_gain
from bench.basics.progress import SILENT, Progress
from bench.dataset.robot import Robot
from bench.scenario.scenario import Scenario, per_joint, resolve_trajectories
from bench.scenario.tables import RecordingTable
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.machine import Machine, build_machine
from bench.truth.motion import MotionRun, Timing, TrueMotion, simulate_motion
from bench.truth.sensors import Log, sense

Array = NDArray[np.float64]

LARGEST_GAP = 1e-4  # m: a loop with a wider gap counts as broken
LARGEST_TRACKING_ERROR = {HINGE: 0.3, SLIDE: 0.1}  # rad, m


@dataclass(frozen=True, eq=False)
class SimulatedRecording:
    """One recording of a simulation, with its truth."""

    table: RecordingTable
    trajectory: FourierTrajectory
    motion: TrueMotion
    position: Array
    """(N, n) readings of encoders without noise and quantisation: true positions of the motors plus errors by hidden
    effects.
    """
    current: Array
    """(N, n) true current references, in the drive's unit."""
    loop_gap: float
    """Largest opening of a loop, m; 0 without loops."""
    log: Log

    @property
    def name(self) -> str:
        """The recording's name in the scenario."""
        return self.table.name


@dataclass(frozen=True, eq=False)
class Simulation:
    """A simulated scenario."""

    scenario: Scenario
    machine: Machine
    recordings: tuple[SimulatedRecording, ...]
    steps: int
    """Steps of the simulation, over all recordings."""
    seconds: float
    """Computing time of the closed loop, s."""

    @property
    def robot(self) -> Robot:
        """The robot of the scenario."""
        return self.scenario.robot

    @property
    def loop_gap(self) -> float:
        """Largest opening of a loop in any recording, m."""
        return max(recording.loop_gap for recording in self.recordings)


def simulate(
    scenario: Scenario,
    trajectories: Mapping[str, FourierTrajectory] | None = None,
    threads: int = 2,
    progress: Progress = SILENT,
) -> Simulation:
    """Simulate all recordings of a scenario; the same scenario gives the same numbers to the last bit.

    trajectories: by recording name; without them those of `resolve_trajectories`.
    threads: number for the computation, without influence on the result. progress: reports every finished part.
    Raises BenchError if the machine cannot be built, the simulation diverges, a loop opens by more than the
    tolerance `loop_gap` of the scenario (1e-4 m if it has none), the tracking error exceeds its limit, or a joint
    reaches its end stop.
    """
    settings = scenario.settings
    given = resolve_trajectories(scenario) if trajectories is None else trajectories
    machine = build_machine(scenario)
    timing = Timing(settings.step, scenario.log_every, round(settings.settle / scenario.log_period))
    runs = [
        MotionRun(r.name, r.payload, given[r.name], round(given[r.name].duration / scenario.log_period))
        for r in settings.recordings
    ]
    start = time.perf_counter()
    try:
        motions = simulate_motion(machine, runs, timing, threads, progress)
    except BenchError as error:
        raise BenchError(f"scenario {scenario.name}: {error}") from error
    seconds = time.perf_counter() - start
    recordings = tuple(
        _recorded(scenario, machine, table, run.trajectory, motion)
        for table, run, motion in zip(settings.recordings, runs, motions, strict=True)
    )
    samples = timing.settle + max(run.samples for run in runs)
    return Simulation(scenario, machine, recordings, len(runs) * samples * timing.log_every, seconds)


def _recorded(
    scenario: Scenario,
    machine: Machine,
    table: RecordingTable,
    trajectory: FourierTrajectory,
    motion: TrueMotion,
) -> SimulatedRecording:
    position = motion.qpos[:, machine.motor_addresses] + machine.drive.offset + motion.misread
    current = motion.current
    model = machine.models[table.payload]
    gap = float(motion.gaps.max(initial=0.0))
    for fault in (
        _tracking_fault(scenario, motion, position),
        _end_stop_fault(model, motion),
        _gap_fault(scenario, gap),
    ):
        if fault is not None:
            raise BenchError(f"scenario {scenario.name}: recording {table.name!r}: {fault}")
    log = sense(
        scenario.settings.sensors,
        scenario.robot.driven,
        scenario.settings.seed,
        table.name,
        motion.time,
        position,
        current,
    )
    return SimulatedRecording(table, trajectory, motion, position, current, gap, log)


def _tracking_fault(scenario: Scenario, motion: TrueMotion, position: Array) -> str | None:
    robot, limit = scenario.robot, scenario.settings.controller.tracking_limit
    if limit is None:
        largest = np.array([LARGEST_TRACKING_ERROR[units_of_gain(a.gain_unit)] for a in robot.motors])
    else:
        largest = per_joint(limit, robot.driven)
    excess = np.abs(motion.reference - position) - largest
    late = np.argmax((excess > 0).any(axis=1))
    joint = int(np.argmax(excess[late]))
    if not excess[late, joint] > 0:
        return None
    return (
        f"the controller lost joint {robot.driven[joint]} at {motion.time[late]:.3f} s: it is"
        f" {abs(motion.reference[late, joint] - position[late, joint]):.3g} away from its reference"
        " (controller.tracking_limit allows more)"
    )


def _end_stop_fault(model: mujoco.MjModel, motion: TrueMotion) -> str | None:
    for joint in range(model.njnt):
        if not model.jnt_limited[joint] or model.jnt_type[joint] not in (
            int(mujoco.mjtJoint.mjJNT_HINGE),
            int(mujoco.mjtJoint.mjJNT_SLIDE),
        ):
            continue
        q = motion.qpos[:, model.jnt_qposadr[joint]]
        low, high = model.jnt_range[joint]
        outside = (q < low) | (q > high)
        if outside.any():
            at = int(np.argmax(outside))
            return (
                f"joint {model.joint(joint).name or f'joint_{joint}'} reaches its end stop at {motion.time[at]:.3f} s:"
                f" {q[at]:.4g} is outside {low:g} to {high:g}"
            )
    return None


def _gap_fault(scenario: Scenario, gap: float) -> str | None:
    limit = scenario.settings.tolerances.get("loop_gap", LARGEST_GAP)
    if gap <= limit:
        return None
    return f"a loop opens by {gap:.2g} m, more than {limit:.2g} m: a smaller step or a slower motion may help"
