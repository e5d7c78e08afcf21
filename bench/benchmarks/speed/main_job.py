"""Cost of the main job: simulation, compared with `mujoco.rollout`, and identification from two recordings of 20 s at
1 kHz; and of the longest simulation, of a hexapod, with the design of its trajectories.

Simulation and rollout run the same models over the same steps, alternately and on one thread, so that other load on the
machine cancels in their ratio.
"""

from dataclasses import replace
from time import perf_counter

import mujoco
import numpy as np
from mujoco import rollout

from bench.benchmarks.speed.figures import SpeedFigure
from bench.excitation.scenario import designer
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation, simulate

SIMULATION_LIMIT = 2.0  # times mujoco.rollout
HEXAPOD, HEXAPOD_LIMIT = "stewart", 15.0  # s
IDENTIFICATION_LIMITS = {"five_bar": 1.0, "delta": 4.0}  # s


def main_job_figures() -> list[SpeedFigure]:
    """Time of a simulation over that of rollout, of an identification, and of a hexapod's design and simulation."""
    start = perf_counter()
    scenario = load_scenario(HEXAPOD)
    simulate(scenario, resolve_trajectories(scenario, designer))
    seconds = perf_counter() - start
    figures = [SpeedFigure("simulate a hexapod, design included", seconds, "s", HEXAPOD_LIMIT)]
    for robot, limit in IDENTIFICATION_LIMITS.items():
        ratio, seconds = measure(robot)
        figures += [
            SpeedFigure(f"simulation over mujoco.rollout, {robot}", ratio, "×", SIMULATION_LIMIT),
            SpeedFigure(f"identify two recordings of 20 s, {robot}", seconds, "s", limit),
        ]
    return figures


def measure(name: str, repeats: int = 5) -> tuple[float, float]:
    """Time of a simulation over that of mujoco.rollout, and seconds to identify from its recordings; medians."""
    scenario = load_scenario(name)
    trajectories = resolve_trajectories(scenario, designer)
    times = np.empty((repeats, 3))
    for repeat in range(repeats):
        start = perf_counter()
        simulation = simulate(scenario, trajectories, threads=1)
        times[repeat, 0] = perf_counter() - start
        times[repeat, 1] = plain_rollout(simulation)
        dataset = as_dataset(simulation)
        fitted = tuple(recording for recording in dataset.recordings if recording.use == "identify")
        start = perf_counter()
        identify(prepare(problem_of(replace(dataset, recordings=fitted))))
        times[repeat, 2] = perf_counter() - start
    return float(np.median(times[:, 0] / times[:, 1])), float(np.median(times[:, 2]))


def plain_rollout(simulation: Simulation, copies: int = 1, threads: int = 1) -> float:
    """Seconds of mujoco.rollout for `copies` of the same models, controls and steps, on `threads` threads."""
    machine, settings = simulation.machine, simulation.scenario.settings
    models = [machine.models[recording.table.payload] for recording in simulation.recordings]
    time = np.arange(simulation.steps // len(models)) * settings.step - settings.settle
    control = np.stack(
        [machine.drive.command(*recording.trajectory.evaluate(time)) for recording in simulation.recordings]
    )
    size = mujoco.mj_stateSize(models[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state = np.zeros((len(models), size))
    state[:, 1 : 1 + models[0].nq] = [recording.motion.qpos[0] for recording in simulation.recordings]
    datas = [mujoco.MjData(models[0]) for _ in range(threads)]
    state, control = (np.tile(values, (copies, *(1,) * (values.ndim - 1))) for values in (state, control))
    start = perf_counter()
    rollout.rollout(models * copies, datas, state, control)
    return perf_counter() - start
