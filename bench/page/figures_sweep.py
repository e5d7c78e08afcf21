"""Figures of a sweep on a page: a metric against an axis, metrics over two axes, and histograms over all runs."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import prod
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bench.basics.shell_word import quoted
from bench.document.charts.chart import Axis, Cells, Chart, Panel, Whiskers, is_wide
from bench.document.typeset import typeset
from bench.effects.display_names import begun
from bench.page.chart_spec import chart_figure, significant, spec_of
from bench.page.parts import Choice, Figure, Items, PageChart, Part, Runs, RunsColumn, Variant
from bench.studies.sweep.charts import ROLES, plot_chart, point_label, spread_chart, value_text
from bench.studies.sweep.metrics import axis_parts, axis_title, is_relative, is_share, metric_title
from bench.studies.sweep.plan import Plan
from bench.studies.sweep.summary import Spread, Summary, SummaryLine
from bench.studies.sweep.table import column_names, read_table

MOST_LETTERS = 70  # of the names below an axis, before they are turned
HIGH, LOW, SPREAD = 300, 200, 210  # px
MOST_VARIANTS = 60
CELL, HEAD, FOOT = 30, 30, 60  # px: height of a cell, and of the room above and below all cells
CELL_WIDTH, NAMES_WIDTH = 58, 150  # px, at least: a phone scrolls
MOST_RUNS = 5000
AID = (
    "A click on a cell or a dot above shows its runs here, as the filters do. A click on a run chooses it: the command "
    "below simulates it again, as it was to the last bit, and shows it in motion; several stand side by side; without "
    "any, a good, a middling and a bad one."
)


def plot_figure(table: Path, x: str, y: str, lines: str | None, picked: Collection[str] = ()) -> Figure:
    """A metric against an axis; if there are more lines than colours, each has a chart, side by side."""
    chart = plot_chart(table, x, y, lines, picked)
    names = chart.x.categories
    turned = sum(map(len, names)) > MOST_LETTERS
    room = 6 * max(map(len, names)) if turned else 0
    drawn = [series for series in chart.series if isinstance(series, Whiskers)]
    if len(drawn) <= len(ROLES):
        return chart_figure(chart, HIGH + room, turned=turned)
    charts = tuple(
        PageChart(alone.name, "", spec_of(_only(chart, alone), LOW + room, turned=turned)) for alone in drawn
    )
    return Figure(chart.title, chart.aid, False, (), {"": Variant(charts)}, ("",))


def _only(chart: Chart, kept: Whiskers) -> Chart:
    """The chart with only one of its lines, which then needs no name."""
    (panel,) = chart.panels
    rest = tuple(series for series in panel.series if not isinstance(series, Whiskers))
    series = (*rest, replace(kept, name="", role=ROLES[0]))
    return replace(chart, panels=(replace(panel, series=series),))


def spread_figure(columns: Mapping[str, Sequence[Any]], metrics: Sequence[str]) -> Figure:
    """A histogram of each metric over all runs."""
    charts = [spread_chart(metric, columns[metric]) for metric in metrics]
    shown = tuple(PageChart(chart.title, "", spec_of(chart, SPREAD)) for chart in charts)
    aid = "How many runs fall where; none is left out."
    return Figure("Histograms", aid, False, (), {"": Variant(shown)}, ("",))


Place = tuple[Any, ...]


@dataclass(frozen=True)
class _Grid:
    """The two axes of a grid, the other axes, the values of all of them, and the results of every combination."""

    across: str
    down: str
    others: tuple[str, ...]
    values: Mapping[str, tuple[Any, ...]]
    lines: Mapping[Place, SummaryLine]

    def spread(self, metric: str, at: Mapping[str, Any]) -> Spread | None:
        """A metric's spread at these values of the axes; None if no run there gave a result."""
        line = self.lines.get(tuple(at[axis] for axis in self.values))
        value = line.spreads[metric] if line is not None else None
        return value if value is not None and value.count else None


def grid_figure(summary: Summary, plots: Sequence[tuple[str, str | None]]) -> Figure | None:
    """The metrics of a sweep over two of its axes.

    None if fewer than two axes have several values, if no metric was recorded, or with more than `MOST_VARIANTS`
    combinations of the others. plots: axes (x, lines) of the sweep's figures; the first suitable pair is used, else the
    axes with the most values.
    """
    grid = _grid(summary, plots)
    metrics = [name for name in summary.metrics if any(line.spreads[name].count for line in summary.lines)]
    if grid is None or not metrics:
        return None
    choices = [grid.values[axis] for axis in grid.others]
    combinations = prod(map(len, choices))
    if combinations > MOST_VARIANTS:
        return None
    if len(metrics) * combinations > MOST_VARIANTS:
        metrics = metrics[:1]
    titles = tuple(begun(metric_title(name)) for name in metrics)
    asked = [Choice("shown", titles)] if len(metrics) > 1 else []
    for axis, values in zip(grid.others, choices, strict=True):
        asked.append(Choice(axis_title(axis), tuple(map(point_label, values))))
    variants = {}
    for (m, metric), *rest in product(enumerate(metrics), *(enumerate(values) for values in choices)):
        key = [str(m)] if len(metrics) > 1 else []
        at = {axis: value for axis, (_, value) in zip(grid.others, rest, strict=True)}
        variants["|".join([*key, *(str(i) for i, _ in rest)])] = Variant((_chart(grid, metric, at),))
    kind = "means" if all(map(is_share, metrics)) else "medians"
    aid = f"Each cell: {kind} over the seeds; the darker, the larger. A click on a cell shows its runs below."
    what = metric_title(metrics[0]) if len(metrics) == 1 else "metrics"
    title = f"{begun(what)} over {axis_title(grid.down)} and {axis_title(grid.across)}"
    return Figure(title, aid, True, tuple(asked), variants, (next(iter(variants)),))


def _grid(summary: Summary, plots: Sequence[tuple[str, str | None]]) -> _Grid | None:
    values = {
        axis: tuple(dict.fromkeys(line.values[i] for line in summary.lines))
        for i, axis in enumerate(summary.axes)
    }
    several = [axis for axis in summary.axes if len(values[axis]) > 1]
    if len(several) < 2:
        return None
    named = next(((x, lines) for x, lines in plots if x in several and lines in several and x != lines), None)
    across, down = named or sorted(several, key=lambda axis: -len(values[axis]))[:2]
    others = tuple(axis for axis in several if axis not in (across, down))
    lines = {line.values: line for line in summary.lines}
    return _Grid(across, str(down), others, values, lines)


def _chart(grid: _Grid, metric: str, others: Mapping[str, Any]) -> PageChart:
    """The chart of one metric at these values of the other axes; axes with a single value have that one."""
    fixed = {axis: values[0] for axis, values in grid.values.items()} | dict(others)
    columns, rows = _rising(grid.values[grid.across]), _rising(grid.values[grid.down])
    shades = _shades(grid, metric)
    varied = [axis for axis in grid.values if len(grid.values[axis]) > 1]
    points = [{**fixed, grid.across: x, grid.down: y} for x, y in product(columns, rows)]
    spreads = [grid.spread(metric, point) for point in points]
    column, row = np.indices((len(columns), len(rows))).reshape(2, -1)
    shade = np.array([0.0 if spread is None else shades(spread.middle) for spread in spreads])
    texts = tuple("–" if spread is None else value_text(metric, spread.middle) for spread in spreads)
    picks = tuple({axis: point_label(point[axis]) for axis in varied} for point in points)
    cells = Cells("", "before", column, row, shade, texts, picks)
    chart = Chart(
        f"{begun(metric_title(metric))} over {axis_title(grid.down)} and {axis_title(grid.across)}",
        _names(grid.across, columns),
        (Panel(_names(grid.down, rows), (cells,)),),
        legend="none",
    )
    height, least = HEAD + FOOT + CELL * len(rows), NAMES_WIDTH + CELL_WIDTH * len(columns)
    return PageChart("", "", spec_of(chart, height, least=least))


def _names(axis: str, values: Sequence[Any]) -> Axis:
    return Axis(*axis_parts(axis), scale="band", categories=tuple(map(point_label, values)))


def _shades(grid: _Grid, metric: str) -> Any:
    """A function from a value to its shade, 0 to 1, the same in all charts of the metric; logarithmic if is_wide."""
    every = [line.spreads[metric].middle for line in grid.lines.values() if line.spreads[metric].count]
    known = [value for value in every if np.isfinite(value)]
    low, high = min(known, default=0.0), max(known, default=1.0)
    if is_wide(np.array(known)):
        return lambda value: float(np.log(value / low) / np.log(high / low)) if np.isfinite(value) else 0.0
    return lambda value: (value - low) / (high - low) if high > low and np.isfinite(value) else 0.0


def _rising(values: Sequence[Any]) -> list[Any]:
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    return sorted(values) if numbers else list(values)


def runs_part(plan: Plan, table: Path, folder: Path, metrics: Sequence[str]) -> Part:
    """The runs with the varied quantities, their seeds and metrics; for more than `MOST_RUNS`, the table's name."""
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
    ]
    for name in metrics:
        kind: Literal["", "share"] = "share" if is_relative(name) else ""
        rows.append(RunsColumn(begun(metric_title(name)), _numbers(columns[name]), kind=kind))
    reasons = columns.get("reason", [None] * count)
    failed = {
        str(run): typeset(str(reason))
        for run, status, reason in zip(columns["run"], columns["status"], reasons, strict=True)
        if status != "ok"
    }
    return Runs("Every run", AID, tuple(rows), failed, f"bench view {quoted(folder)}")


def _axis(name: str, values: Sequence[Any], *, filtered: bool) -> RunsColumn:
    """The column of an axis; if `filtered`, as indices of its labels, by which runs can be filtered."""
    if not filtered:
        return RunsColumn(axis_title(name), _numbers(values))
    labels = list(dict.fromkeys(map(point_label, values)))
    places = tuple(labels.index(point_label(value)) for value in values)
    return RunsColumn(axis_title(name), places, tuple(labels), name)


def _numbers(values: Sequence[Any]) -> tuple[Any, ...]:
    return tuple(
        value if isinstance(value, int | str | None) else significant([float(value)])[0] for value in values
    )
