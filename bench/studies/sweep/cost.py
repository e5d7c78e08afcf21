"""How much work a sweep is: runs, simulations, and about how long it takes."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import prod
from typing import Any

from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.identification.identify import fit
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import resolve_trajectories, scenario_from_dict
from bench.studies.sweep.axes import Axis, DrawnAxis, GridAxis
from bench.studies.sweep.hidden_share import without_share
from bench.studies.sweep.plan import FITTING, MACHINE, MOVEMENT, Plan, Run, level
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

TRIAL = 3.0  # s of movement
PART = 0.4  # of it, for a second measurement: what takes as long however short the movement is shows
ROUNDS = 2.0  # of a diagnosis: one for the effect that is identified, one that finds no more
DESIGN_SECONDS = 5.0  # of one design, about


@dataclass(frozen=True)
class Extent:
    """Counts; seconds of computing for each, where a trial could tell, on one core."""

    runs: int
    sets: int
    """Of equations: runs that differ by estimator share one."""
    motions: int
    """Simulations: sets that differ by noise or filter share one."""
    designs: int
    """Of exciting trajectories."""
    motion_seconds: float | None
    set_seconds: float | None

    def seconds(self, workers: int) -> float | None:
        """About how long it takes."""
        if self.motion_seconds is None or self.set_seconds is None:
            return None
        together = self.motions * self.motion_seconds + self.sets * self.set_seconds
        return together / workers + DESIGN_SECONDS * -(-self.designs // workers)


def extent(plan: Plan, *, trial: bool = True) -> Extent:
    """Count, and try out a few seconds of the first run's movement (without `trial`, count only)."""
    axes, seeds = plan.sweep.axes, len(plan.sweep.seeds)
    first = plan.run(0)
    drawn_gains = bool((first.content.get("gains") or {}).get("error_within"))
    motion_axes = [axis for axis in axes if level(axis) <= MACHINE]
    design_axes = [axis for axis in axes if level(axis) == MOVEMENT or (_on_payload(axis) and _each(plan))]
    by_seed = drawn_gains or any(isinstance(axis, DrawnAxis) for axis in motion_axes)
    design_by_seed = any(isinstance(axis, DrawnAxis) for axis in design_axes)
    costs = _trial(plan) if trial else (None, None)
    return Extent(
        runs=plan.size,
        sets=seeds * _points([axis for axis in axes if level(axis) <= FITTING]),
        motions=(seeds if by_seed else 1) * _points(motion_axes),
        designs=(seeds if design_by_seed else 1) * _points(design_axes) if _optimised(first.content) else 0,
        motion_seconds=costs[0],
        set_seconds=costs[1],
    )


def _points(axes: list[Axis]) -> int:
    return prod(len(axis.points) for axis in axes if isinstance(axis, GridAxis))


def _each(plan: Plan) -> bool:
    return plan.sweep.table.design == "each"


def _on_payload(axis: Axis) -> bool:
    paths = axis.paths if isinstance(axis, GridAxis) else (axis.name,)
    return any(path.split(".")[0] == "payloads" for path in paths)


def _optimised(content: Any) -> bool:
    default = (content.get("design") or {}).get("optimise", False)
    return any(
        (recording.get("design") or {}).get("optimise", default)
        for recording in content["recordings"]
        if "design" in recording
    )


def _trial(plan: Plan) -> tuple[float | None, float | None]:
    """Seconds of one simulation and of one set of equations, extrapolated from short random movements."""
    run = plan.run(0)
    content = without_share(run.content)
    whole = scenario_from_dict(content, run.base)
    durations = [table.design.duration for table in whole.settings.recordings if table.design is not None]
    if len(durations) < len(whole.settings.recordings):
        return None, None
    short = {"optimise": False, "duration": TRIAL, "ramp": 0.25}
    recordings = [
        {**recording, "design": {**recording["design"], **short}} for recording in content["recordings"]
    ]
    scenario = scenario_from_dict({**content, "recordings": recordings}, run.base, run.base, whole.robot)
    start = time.perf_counter()
    try:
        simulation = simulate(scenario, resolve_trajectories(scenario), threads=1)
        simulating = time.perf_counter() - start
        whole_data = as_dataset(simulation)
        part = replace(
            whole_data, recordings=tuple(_beginning(recording) for recording in whole_data.recordings)
        )
        _, short_time, long_time = (_identifying(data, run) for data in (part, part, whole_data))
        diagnosing = ROUNDS * _diagnosing(whole_data, run) if run.identify["diagnose"] else 0.0
    except BenchError:  # too short a movement may be too little for this robot, and says nothing
        return None, None
    more = sum(durations) / len(durations) - TRIAL
    slope = max(0.0, long_time - short_time) / ((1 - PART) * TRIAL)
    return simulating + more / TRIAL * simulation.seconds, long_time + slope * more + diagnosing


def _identifying(dataset: Dataset, run: Run) -> float:
    """Seconds that an identification takes."""
    start = time.perf_counter()
    fit(prepare(problem_of(dataset, run.identify["effects"])), run.identify["method"])
    return time.perf_counter() - start


def _diagnosing(dataset: Dataset, run: Run) -> float:
    """Seconds that a look at every effect takes, however long the movement is."""
    start = time.perf_counter()
    diagnose_with_catalogue(problem_of(dataset, run.identify["effects"]))
    return time.perf_counter() - start


def _beginning(recording: Recording) -> Recording:
    """The first part of a recording."""
    return recording.part(slice(0, round(PART * len(recording.time))))
