"""Every run of a sweep, to be filtered by its axes and chosen to be looked at."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bench.basics.shell_word import quoted
from bench.document.typeset import typeset
from bench.effects.display_names import begun
from bench.page.parts import Items, Part, Runs, RunsColumn
from bench.page.thinned import significant
from bench.studies.sweep.charts import point_label
from bench.studies.sweep.metrics import is_relative
from bench.studies.sweep.plan import Plan
from bench.studies.sweep.table import column_names, read_table
from bench.studies.sweep.titles import axis_title, metric_title

MOST_RUNS = 5000
AID = (
    "A click on a cell or a dot above shows its runs here, as the filters do. A click on a run chooses it: the command "
    "below simulates it again, as it was to the last bit, and shows it in motion; several stand side by side; without "
    "any, a good, a middling and a bad one."
)


def runs_part(plan: Plan, table: Path, folder: Path, metrics: Sequence[str]) -> Part:
    """The runs with what was varied, their seeds and their metrics; of very many, where they are."""
    known = column_names(table)
    axes = [axis.name for axis in plan.sweep.axes if axis.name in known and axis.name != "seed"]
    names = ["run", "seed", "status", "reason", *axes, *metrics]
    columns = read_table(table, [name for name in names if name in known])
    count = len(columns["run"])
    if count > MOST_RUNS:
        return Items("Runs", "", (f"{count} runs are more than a page holds: {table.name} has every one.",))
    grid = {axis.name for axis in plan.sweep.grid}
    rows = [
        RunsColumn("run", _numbers(columns["run"])),
        *(_axis(name, columns[name], filtered=name in grid) for name in axes),
        RunsColumn("seed", _numbers(columns["seed"])),
        *(
            RunsColumn(
                begun(metric_title(name)), _numbers(columns[name]), kind="share" if is_relative(name) else ""
            )
            for name in metrics
        ),
    ]
    reasons = columns.get("reason", [None] * count)
    failed = {
        str(run): typeset(str(reason))
        for run, status, reason in zip(columns["run"], columns["status"], reasons, strict=True)
        if status != "ok"
    }
    return Runs("Every run", AID, tuple(rows), failed, f"bench view {quoted(folder)}")


def _axis(name: str, values: Sequence[Any], *, filtered: bool) -> RunsColumn:
    """An axis; one with few values as the numbers of its labels, by which its runs are filtered."""
    if not filtered:
        return RunsColumn(axis_title(name), _numbers(values))
    labels = list(dict.fromkeys(map(point_label, values)))
    places = tuple(labels.index(point_label(value)) for value in values)
    return RunsColumn(axis_title(name), places, tuple(labels), name)


def _numbers(values: Sequence[Any]) -> tuple[Any, ...]:
    return tuple(
        value if isinstance(value, int | str | None) else significant([float(value)])[0] for value in values
    )
