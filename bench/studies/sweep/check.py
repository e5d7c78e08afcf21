"""The command `bench check`: run reference scenarios again, and compare them with the reference or replace it."""

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from rich.console import Console

from bench.basics.errors import BenchError
from bench.basics.plural import plural
from bench.basics.program import typed
from bench.basics.versions import versions
from bench.scenario.scenario import scenario_from_dict
from bench.studies.sweep.plan import Plan
from bench.studies.sweep.pool import LocalPool
from bench.studies.sweep.preflight import check_plan
from bench.studies.sweep.progress import duration_text
from bench.studies.sweep.reference import (
    ALARMS,
    ReferenceComparison,
    ReferenceLine,
    SweepReference,
    chosen_plan,
    compare_line,
    content_of,
    limits_of,
    load_reference,
    measured_lines,
    reference_sweeps,
    save_reference,
    tolerances_of,
)
from bench.studies.sweep.run_plan import Work
from bench.studies.sweep.run_sweep import run_sweep
from bench.studies.sweep.summary import number, plain_table
from bench.studies.sweep.sweep_file import Sweep

COLORS = {"worse": "red", "over its limit": "red", "better": "green", "new": "yellow"}


@dataclass(frozen=True)
class CheckOptions:
    """What to check: all seeds or the quick set, names of sweeps (empty: all), folders of sweeps and of the
    reference.
    """

    reference: Path
    full: bool = False
    only: tuple[str, ...] = ()
    scenarios: Path | None = None
    workers: int | None = None
    verbose: bool = False


def check_accuracy(options: CheckOptions, console: Console, make_work: Callable[[Sweep], Work]) -> int:
    """Run, compare, print; return 1 if a figure is worse, a scenario has changed, or a reference is missing."""
    start = time.monotonic()
    comparisons: list[ReferenceComparison] = []
    alarms = []
    for name, sweep, plan, lines in _measured(options, make_work):
        reference = load_reference(options.reference / f"{name}.json")
        if reference is None:
            alarms.append(f"{name}: has no reference yet; if all is well: bench check --update --reason ...")
        elif reference.content != content_of(sweep):
            alarms.append(
                f"{name}: its scenario has changed; if that is meant: bench check --update --reason ..."
            )
        limits = limits_of(scenario_from_dict(plan.run(0).content, name).settings.tolerances)
        for label, line in lines.items():
            before = reference.lines.get(label) if reference else None
            comparisons += compare_line(name, label, before, line, tolerances_of(sweep), limits)
    _print(console, comparisons, verbose=options.verbose)
    for alarm in alarms:
        console.print(f"[red]{alarm}[/]", soft_wrap=True)
    verdicts: list[str] = [comparison.verdict for comparison in comparisons]
    worse = sum(map(verdicts.count, ALARMS))
    counts = [f"{worse} worse"]
    for verdict, name in (("better", "better"), ("same", "as before"), ("new", "new")):
        count = verdicts.count(verdict)
        counts += [f"{count} {name}"] if count or verdict != "new" else []
    took = duration_text(time.monotonic() - start)
    console.print(f"{len(comparisons)} figures in {took}: {', '.join(counts)}")
    if worse and not (options.full and options.verbose):
        changed = dict.fromkeys(entry.sweep for entry in comparisons if entry.verdict in ALARMS)
        step = f"{typed()} check --full --verbose {' '.join(f'--only {name}' for name in changed)}"
        text = f"next: {step}    runs all of their seeds and shows every figure"
        console.print(text, soft_wrap=True)
    return 1 if worse or alarms else 0


def update_reference(
    options: CheckOptions, reason: str, console: Console, make_work: Callable[[Sweep], Work]
) -> None:
    """Run all seeds and save their results as the reference, with the reason."""
    if not reason.strip():
        raise BenchError("check --update: give the reason for the change with --reason")
    for name, sweep, plan, lines in _measured(options, make_work):
        path = options.reference / f"{name}.json"
        reference = SweepReference(content_of(sweep), reason.strip(), versions().columns(), lines)
        save_reference(path, reference)
        console.print(f"Reference: {path} ({plural(plan.size, 'run')})", soft_wrap=True)


def _chosen(options: CheckOptions) -> dict[str, tuple[Sweep, Plan]]:
    sweeps = reference_sweeps(options.scenarios)
    for name in options.only:
        if name not in sweeps:
            raise BenchError(f"no reference scenario {name!r}; there are {', '.join(sweeps)}")
    chosen = {}
    for name, sweep in sweeps.items():
        plan = chosen_plan(sweep, full=options.full)
        if plan is not None and (not options.only or name in options.only):
            check_plan(plan)
            chosen[name] = (sweep, plan)
    return chosen


def _measured(
    options: CheckOptions, make_work: Callable[[Sweep], Work]
) -> Iterator[tuple[str, Sweep, Plan, dict[str, ReferenceLine]]]:
    """Name, sweep, plan and results, one sweep after the other.

    All sweeps share the workers, and trajectories that several of them need are designed once.
    """
    chosen = _chosen(options)
    workers = options.workers or len(os.sched_getaffinity(0))
    temporary = tempfile.TemporaryDirectory(prefix="bench-check-")
    with LocalPool(workers) as pool, temporary as folder:
        for name, (sweep, plan) in chosen.items():
            lent, quiet = lambda: nullcontext(pool), lambda _: None
            target = Path(folder) / name
            designs = Path(folder) / "designs"
            finished = run_sweep(plan, target, lent, make_work(sweep), quiet, designs=designs)
            lines = measured_lines(plan, finished.table, list(tolerances_of(sweep)))
            yield name, sweep, plan, lines


def _print(console: Console, comparisons: list[ReferenceComparison], *, verbose: bool) -> None:
    """Print the changes, or with `verbose` all figures."""
    shown = [comparison for comparison in comparisons if verbose or comparison.verdict != "same"]
    if not shown:
        return
    table = plain_table([""], ["reference", "now", "change", "allowed", "limit"], no_wrap=True)
    table.add_column("", no_wrap=True)
    order = [*ALARMS, "new", "better", "same"]
    for (sweep, line), of_line in groupby(shown, lambda compared: (compared.sweep, compared.line)):
        table.add_row(f"{sweep}, {line}" if line else sweep, style="bold")
        ranked = sorted(of_line, key=lambda each: (order.index(each.verdict), -(each.change or 0.0)))
        for comparison in ranked:
            style = COLORS.get(comparison.verdict)
            table.add_row(f"  {comparison.metric}", *_cells(comparison), style=style)
    console.print(table)
    console.print("[dim]Change for the worse, in units of the spread from seed to seed.[/]")


def _cells(comparison: ReferenceComparison) -> list[str]:
    return [
        _text(comparison.reference),
        _text(comparison.now),
        "–" if comparison.change is None else f"{comparison.change:+.2g} σ",
        f"{comparison.tolerance:g} σ",
        "" if comparison.limit is None else number(comparison.limit),
        comparison.verdict,
    ]


def _text(value: float | None) -> str:
    return "–" if value is None else number(value)
