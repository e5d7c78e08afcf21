"""A metric over two axes of a sweep, as a matrix of shaded cells; other axes are chosen, never thrown together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from bench.document.charts.chart import Axis, Cells, Chart, Panel, is_wide
from bench.effects.display_names import begun
from bench.page.chart_spec import spec_of
from bench.page.parts import Choice, Figure, PageChart, Variant
from bench.studies.sweep.charts import point_label, value_text
from bench.studies.sweep.metrics import is_share
from bench.studies.sweep.summary import Spread, Summary, SummaryLine
from bench.studies.sweep.titles import axis_parts, axis_title, metric_title

MOST_VARIANTS = 60
CELL, HEAD, FOOT = 30, 30, 60  # px: height of a cell, above and below all of them
CELL_WIDTH, NAMES_WIDTH = 58, 150  # px, that a phone scrolls

Place = tuple[Any, ...]


@dataclass(frozen=True)
class _Grid:
    """Two axes, the others with the values that were tried, and the spreads of every combination."""

    across: str
    down: str
    others: tuple[str, ...]
    values: Mapping[str, tuple[Any, ...]]
    lines: Mapping[Place, SummaryLine]

    def spread(self, metric: str, at: Mapping[str, Any]) -> Spread | None:
        """A metric where the axes have these values; None where no run came to an answer."""
        line = self.lines.get(tuple(at[axis] for axis in self.values))
        value = line.spreads[metric] if line is not None else None
        return value if value is not None and value.count else None


def grid_figure(summary: Summary, plots: Sequence[tuple[str, str | None]]) -> Figure | None:
    """The metrics of a sweep over two of its axes; None where fewer than two have several values.

    plots: axes (x, lines) of the sweep's figures, the first of which decide which two.
    """
    grid = _grid(summary, plots)
    metrics = [name for name in summary.metrics if any(line.spreads[name].count for line in summary.lines)]
    if grid is None or not metrics:
        return None
    choices = [grid.values[axis] for axis in grid.others]
    if len(metrics) * int(np.prod([len(values) for values in choices])) > MOST_VARIANTS:
        metrics = metrics[:1]
    if int(np.prod([len(values) for values in choices])) > MOST_VARIANTS:
        return None
    asked = (
        [Choice("shown", tuple(begun(metric_title(name)) for name in metrics))] if len(metrics) > 1 else []
    )
    asked += [
        Choice(axis_title(axis), tuple(map(point_label, values)))
        for axis, values in zip(grid.others, choices, strict=True)
    ]
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
    """The chart of one metric where the other axes have these values; single values stand for themselves."""
    fixed = {axis: values[0] for axis, values in grid.values.items()} | dict(others)
    columns, rows = _rising(grid.values[grid.across]), _rising(grid.values[grid.down])
    shades = _shades(grid, metric)
    places, middles, picks = [], [], []
    for (i, x), (k, y) in product(enumerate(columns), enumerate(rows)):
        point = {**fixed, grid.across: x, grid.down: y}
        spread = grid.spread(metric, point)
        places.append((i, k))
        middles.append(None if spread is None else _middle(metric, spread))
        picks.append(
            {axis: point_label(value) for axis, value in point.items() if len(grid.values[axis]) > 1}
        )
    at = np.array(places)
    cells = Cells(
        "before",
        at[:, 0],
        at[:, 1],
        np.array([0.0 if middle is None else shades(middle) for middle in middles]),
        tuple("–" if middle is None else value_text(metric, middle) for middle in middles),
        tuple(picks),
    )
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


def _middle(metric: str, spread: Spread) -> float:
    return spread.mean if is_share(metric) else spread.median


def _shades(grid: _Grid, metric: str) -> Any:
    """From a value to its shade, 0 to 1, the same in all charts of the metric; logarithmic over a wide range."""
    every = [
        _middle(metric, line.spreads[metric]) for line in grid.lines.values() if line.spreads[metric].count
    ]
    known = [value for value in every if np.isfinite(value)]
    low, high = min(known, default=0.0), max(known, default=1.0)
    if is_wide(np.array(known)):
        return lambda value: float(np.log(value / low) / np.log(high / low)) if np.isfinite(value) else 0.0
    return lambda value: (value - low) / (high - low) if high > low and np.isfinite(value) else 0.0


def _rising(values: Sequence[Any]) -> list[Any]:
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    return sorted(values) if numbers else list(values)
