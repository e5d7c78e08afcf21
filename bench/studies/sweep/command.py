"""The command `bench sweep`: check, run, show."""

from __future__ import annotations

import time
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from bench.studies.sweep.console import table_console
from bench.studies.sweep.cost import Extent, extent
from bench.studies.sweep.plan import Plan, make_plan
from bench.studies.sweep.preflight import check_plan, fixed_declarations
from bench.studies.sweep.print_summary import print_summary
from bench.studies.sweep.progress import duration_text, progress_console, shown_progress
from bench.studies.sweep.results import SUMMARY, write_plots, write_summary
from bench.studies.sweep.run_sweep import Finished, run_sweep, written
from bench.studies.sweep.sweep_file import load_sweep
from bench.studies.sweep.table import read_table
from bench.studies.sweep.work import FAILED, IdentificationWork
from bench.studies.sweep.workers import ON_ALL_CORES, Workers

MOST_REASONS = 5


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
    console.print(f"[bold]{name}[/]  {description}", highlight=False)
    console.print(_extent_text(plan, extent(plan), workers), highlight=False, markup=False)
    for note in fixed_declarations(plan):
        console.print(note, highlight=False, markup=False)
    if dry_run or folder is None:
        return 0

    def resumed(kept: int) -> None:
        remaining = plan.size - kept
        console.print(f"{kept} of {plan.size} runs are there from before, {remaining} to go", highlight=False)

    start = time.monotonic()
    with shown_progress(progress_console(quiet), plan.size) as report:
        work = IdentificationWork(plan.sweep.table.record)
        try:
            finished = run_sweep(
                plan,
                folder,
                workers.pool,
                work,
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
    counts = ", ".join([*axes, _counted(len(plan.sweep.seeds), "seed"), *(f"{name} drawn" for name in drawn)])
    text = f"{_counted(work.runs, 'run')} ({counts}), {_counted(work.motions, 'simulation')}"
    if work.designs:
        text += f", {_counted(work.designs, 'design')} of trajectories"
    if workers.scheduler is not None:
        return f"{text}, on {workers.scheduler}"
    seconds = work.seconds(workers.count)
    about = "" if seconds is None else f", about {duration_text(seconds)}"
    return f"{text}{about} with {_counted(workers.count, 'worker')}"


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


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
    text = f"{_counted(made, 'run')} in {duration_text(seconds)}{kept}, {finished.failed} failed"
    console.print(text, highlight=False)
    for name, path in (("table", finished.table), ("summary", finished.folder / SUMMARY)):
        console.print(f"wrote {path} ({name})", highlight=False, soft_wrap=True)
    for path in plots:
        console.print(f"wrote {path} (figure)", highlight=False, soft_wrap=True)
    return 1 if finished.failed == finished.runs else 0


def _show_failures(console: Console, finished: Finished) -> None:
    columns = read_table(finished.table, ["run", "status", "reason"])
    reasons: dict[str, list[int]] = {}
    for run, status, reason in zip(*columns.values(), strict=True):
        if status == FAILED:
            reasons.setdefault(reason, []).append(run)
    for reason, runs in sorted(reasons.items(), key=lambda item: -len(item[1]))[:MOST_REASONS]:
        which = f"run {runs[0]}" if len(runs) == 1 else f"{len(runs)} runs, first {runs[0]}"
        console.print(f"[red]failed[/] ({which}): {escape(reason)}", highlight=False, soft_wrap=True)
    if len(reasons) > MOST_REASONS:
        console.print(f"… and for {len(reasons) - MOST_REASONS} other reasons: see the column `reason`")
