"""The command `bench sweep`: check, estimate the run time, run, show."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.markup import escape

from bench.basics.errors import BenchError
from bench.basics.plural import plural
from bench.dataset.dataset import Dataset
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.identification.identify import fit
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import resolve_trajectories, scenario_from_dict
from bench.studies.sweep.axes import Axis, DrawnAxis, GridAxis
from bench.studies.sweep.hidden_share import without_share
from bench.studies.sweep.plan import FITTING, MACHINE, MOVEMENT, Plan, level, make_plan
from bench.studies.sweep.pool import ON_ALL_CORES, Workers
from bench.studies.sweep.preflight import check_plan, fixed_declarations
from bench.studies.sweep.progress import duration_text, progress_console, shown_progress
from bench.studies.sweep.results import SUMMARY, failed_runs, write_plots, write_summary
from bench.studies.sweep.run_sweep import Finished, run_sweep, written
from bench.studies.sweep.summary import print_summary, table_console
from bench.studies.sweep.sweep_file import load_sweep
from bench.studies.sweep.work import identification_work
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

TRIAL = 3.0  # s of motion
PART = 0.4  # share of it for a second measurement, which shows the time that does not depend on the duration
ROUNDS = 2.0  # of a diagnosis: one that identifies an effect, one that identifies no more
DESIGN_SECONDS = 5.0  # approximate time of one design
MOST_REASONS = 5
Result = TypeVar("Result")


@dataclass(frozen=True)
class Extent:
    """Number of each kind of task, and its computing time on one core, s, None if a trial could not measure it."""

    runs: int
    sets: int
    """Sets of equations: runs that differ only in the estimator share one."""
    motions: int
    """Simulations: sets that differ only in noise or filter share one."""
    designs: int
    """Designs of exciting trajectories."""
    motion_seconds: float | None
    set_seconds: float | None

    def seconds(self, workers: int) -> float | None:
        """Approximate computing time with a number of workers, s."""
        if self.motion_seconds is None or self.set_seconds is None:
            return None
        together = self.motions * self.motion_seconds + self.sets * self.set_seconds
        return together / workers + DESIGN_SECONDS * -(-self.designs // workers)


def extent(plan: Plan, *, trial: bool = True) -> Extent:
    """Count the tasks, and with `trial` measure their time on a few seconds of the first run's motion."""
    axes, seeds = plan.sweep.axes, len(plan.sweep.seeds)
    first = plan.run(0)
    drawn_gains = bool((first.content.get("gains") or {}).get("error_within"))
    motion_axes = [axis for axis in axes if level(axis) <= MACHINE]
    also = ("payloads",) if plan.sweep.table.design == "each" else ()
    design_axes = [
        axis
        for axis in axes
        if level(axis) == MOVEMENT or any(path.split(".")[0] in also for path in axis.paths)
    ]
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


def _optimised(content: Any) -> bool:
    default = (content.get("design") or {}).get("optimise", False)
    return any(
        (recording.get("design") or {}).get("optimise", default)
        for recording in content["recordings"]
        if "design" in recording
    )


def _trial(plan: Plan) -> tuple[float | None, float | None]:
    """Seconds of one simulation and of one set of equations, extrapolated from short random motions."""
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
    effects, method = run.identify["effects"], run.identify["method"]

    def fitting(dataset: Dataset) -> float:
        return _timed(lambda: fit(prepare(problem_of(dataset, effects)), method))[0]

    try:
        simulating, simulation = _timed(lambda: simulate(scenario, resolve_trajectories(scenario), threads=1))
        data = as_dataset(simulation)
        logs = tuple(log.part(slice(0, round(PART * len(log.time)))) for log in data.recordings)
        part = replace(data, recordings=logs)
        _, short_time, long_time = map(fitting, (part, part, data))
        diagnosing = 0.0  # hardly depends on the duration of the motion
        if run.identify["diagnose"]:
            diagnosing = ROUNDS * _timed(lambda: diagnose_with_catalogue(problem_of(data, effects)))[0]
    except BenchError:  # a short motion may not suffice for this robot, which says nothing about the sweep
        return None, None
    more = sum(durations) / len(durations) - TRIAL
    slope = max(0.0, long_time - short_time) / ((1 - PART) * TRIAL)
    return simulating + more / TRIAL * simulation.seconds, long_time + slope * more + diagnosing


def _timed(work: Callable[[], Result]) -> tuple[float, Result]:
    """Computing time, s, and the result."""
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def run_command(
    sweep_file: str,
    folder: Path | None,
    *,
    workers: Workers = ON_ALL_CORES,
    retry_failed: bool = False,
    dry_run: bool = False,
    quiet: bool = False,
) -> int:
    """Run a sweep and write table, summary and figures into `folder`; returns the exit code."""
    console = table_console()
    if not dry_run:
        workers.warm_up()
    plan = make_plan(load_sweep(sweep_file))
    check_plan(plan)
    name, description = escape(plan.sweep.name), escape(plan.sweep.table.description)
    console.print(f"[bold]{name}[/]  {description}")
    console.print(_extent_text(plan, extent(plan), workers), markup=False)
    for note in fixed_declarations(plan):
        console.print(note, markup=False)
    if dry_run or folder is None:
        return 0

    def resumed(kept: int) -> None:
        remaining = plan.size - kept
        console.print(f"{kept} of {plan.size} runs are there from before, {remaining} to go")

    start = time.monotonic()
    with shown_progress(progress_console(quiet), plan.size) as report:
        try:
            finished = run_sweep(
                plan,
                folder,
                workers.pool,
                identification_work(plan.sweep),
                report,
                retry_failed=retry_failed,
                phase=report.phase,
                resumed=resumed,
            )
        except KeyboardInterrupt:
            console.print("Stopped. Finished runs are kept: the same command goes on with the others.")
            raise
    with written(folder):
        return _show(console, plan, finished, time.monotonic() - start)


def _extent_text(plan: Plan, work: Extent, workers: Workers) -> str:
    axes = [f"{len(axis.points)} × {axis.name}" for axis in plan.sweep.grid]
    drawn = [name for name in plan.axis_names if name not in {axis.name for axis in plan.sweep.grid}]
    counts = ", ".join([*axes, plural(len(plan.sweep.seeds), "seed"), *(f"{name} drawn" for name in drawn)])
    text = f"{plural(work.runs, 'run')} ({counts}), {plural(work.motions, 'simulation')}"
    if work.designs:
        text += f", {plural(work.designs, 'design')} of trajectories"
    if workers.scheduler is not None:
        return f"{text}, on {workers.scheduler}"
    seconds = work.seconds(workers.count)
    about = "" if seconds is None else f", about {duration_text(seconds)}"
    return f"{text}{about} with {plural(workers.count, 'worker')}"


def _show(console: Console, plan: Plan, finished: Finished, seconds: float) -> int:
    summary = write_summary(plan, finished.folder)
    plots = write_plots(plan, finished.folder)
    console.print()
    print_summary(summary, console)
    console.print()
    if finished.failed:
        _show_failures(console, finished)
    made = finished.runs - finished.kept
    kept = f", {finished.kept} kept from before" if finished.kept else ""
    text = f"{plural(made, 'run')} in {duration_text(seconds)}{kept}, {finished.failed} failed"
    console.print(text)
    files = [(finished.table, "table"), (finished.folder / SUMMARY, "summary")]
    for path, name in (*files, *((plot, "figure") for plot in plots)):
        console.print(f"wrote {path} ({name})", soft_wrap=True)
    return 1 if finished.failed == finished.runs else 0


def _show_failures(console: Console, finished: Finished) -> None:
    reasons = failed_runs(finished.table)
    for reason, runs in list(reasons.items())[:MOST_REASONS]:
        which = f"run {runs[0]}" if len(runs) == 1 else f"{len(runs)} runs, first {runs[0]}"
        console.print(f"[red]failed[/] ({which}): {escape(reason)}", soft_wrap=True)
    if len(reasons) > MOST_REASONS:
        console.print(f"… and for {len(reasons) - MOST_REASONS} other reasons: see the column `reason`")
