"""Charts of a sweep: a metric against an axis, and the distribution of a metric over all runs."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.basics.chi_squared import CONFIDENCE
from bench.basics.sentence import and_list
from bench.document.charts.chart import Axis, Chart, Histogram, Panel, Role, Rule, Whiskers, is_wide
from bench.document.typeset import share, short, typeset
from bench.effects.display_names import begun
from bench.studies.sweep.metrics import (
    axis_parts,
    axis_title,
    axis_words,
    is_relative,
    is_share,
    metric_of,
    metric_title,
    what_is_measured,
)
from bench.studies.sweep.summary import Spread, SummaryPart, rank, summarise

ROLES: tuple[Role, ...] = ("one", "two", "three", "four", "five", "six", "seven")
STEP = 0.008  # offset between lines, as a share of the axis
STEP_OF_NAMES = 0.1  # the same on an axis of names, as a share of the room of a name
SLABS = 24

Points = list[tuple[Any, Spread]]


def value_text(metric: str, value: float) -> str:
    """A metric's value as text; relative ones in percent."""
    return share(value) if is_relative(metric) else short(value, 3)


def point_label(value: Any) -> str:
    """A value of an axis, as text."""
    return short(value, 5) if isinstance(value, float) else str(value)


def metric_axis(metric: str, **more: Any) -> Axis:
    """The axis of a metric: its title and its unit."""
    unit = "%" if is_relative(metric) else metric_of(metric).unit
    return Axis(begun(metric_title(metric)), unit, **more)


def plot_chart(
    table: Path,
    x: str,
    y: str,
    lines: str | None = None,
    picked: Collection[str] = (),
    *,
    logarithmic: bool | None = None,
) -> Chart:
    """Median and middle 90 % of a metric against an axis, a line for each value of another one.

    For a share, the mean with its 95 % interval. picked: axes with several values, in all combinations; if x and
    lines are among them, a point can be chosen to show its runs. logarithmic: scale of the y axis; by default
    logarithmic if its values span a wide range. Raises BenchError if the table has no such column.
    """
    pick = {x, *([lines] if lines else [])} <= set(picked)
    by_line = _points(table, x, y, lines)
    every = [point for points in by_line.values() for point in points]
    values = list(dict.fromkeys(value for value, _ in every))
    across, at = _across(x, values)
    series = []
    for i, (name, points) in enumerate(by_line.items()):
        # lines are side by side, since their whiskers would overlap
        offset = i - (len(by_line) - 1) / 2.0 if len(by_line) <= len(ROLES) else 0.0
        place = _moved(np.array([at[value] for value, _ in points]), list(at.values()), offset, across)
        line_pick = {} if lines is None else {lines: point_label(name)}
        series.append(
            Whiskers(
                f"{axis_words(lines)} {_short(name)}" if lines else "",
                ROLES[i % len(ROLES)],
                place,
                np.array([spread.middle for _, spread in points]),
                np.array([spread.low for _, spread in points]),
                np.array([spread.high for _, spread in points]),
                joined=across.scale != "band",
                pick=tuple({x: point_label(value), **line_pick} for value, _ in points) if pick else (),
            )
        )
    marks = (Rule("95 %", "noise", "y", CONFIDENCE, dashed=True),) if is_share(y) else ()
    by = f", by {axis_title(lines)}" if lines else ""
    together = [axis_words(axis) for axis in picked if axis not in (x, lines)] if pick else []
    pooled = f" All values together of {and_list(together)}." if together else ""
    reading = (
        "means; whiskers: 95 % intervals" if is_share(y) else "medians; whiskers: the middle 90 % of runs"
    )
    return Chart(
        begun(f"{metric_title(y)} against {axis_title(x)}{by}"),
        across,
        (Panel(_up(y, every, logarithmic), (*marks, *series)),),
        aid=f"{begun(what_is_measured(y))}. Dots: {reading}.{pooled}",
    )


def spread_chart(metric: str, values: Sequence[Any]) -> Chart:
    """A histogram of a metric over all runs, and its median."""
    known = np.array([np.nan if value is None else float(value) for value in values])
    known = known[np.isfinite(known)]
    counts, edges = np.histogram(known, bins=min(SLABS, max(5, len(known) // 4)))
    bars = Histogram("runs", "after", edges, counts)
    median = Rule("median", "modelled", "x", float(np.median(known)))
    x, y = metric_axis(metric), Axis("runs", include=(0.0,))
    return Chart(begun(metric_title(metric)), x, (Panel(y, (bars, median)),))


def _points(table: Path, x: str, y: str, lines: str | None) -> dict[Any, Points]:
    """Points by the value of `lines`: values of x with the spread of y; numbers are in rising order."""
    points: dict[Any, Points] = {}
    for line in summarise(table, [x, *([lines] if lines else [])], [y], in_parts=True).lines:
        at, *names = line.values
        if at is not None and line.spreads[y].count:
            value = at.middle if isinstance(at, SummaryPart) else at
            points.setdefault(names[0] if names else None, []).append((value, line.spreads[y]))
    return {name: points[name] for name in sorted(points, key=rank)}


def _across(x: str, values: Sequence[Any]) -> tuple[Axis, dict[Any, float]]:
    """The horizontal axis, and the position of each value on it."""
    words, unit = axis_parts(x)
    if not all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        names = tuple(str(value).replace("_", " ") for value in values)
        axis = Axis(words, unit, "band", categories=names)
        return axis, {value: float(i) for i, value in enumerate(values)}
    at = {value: float(value) for value in values}
    wide = is_wide(np.array(list(at.values())))
    return Axis(words, unit, "log") if wide else Axis(words, unit, room=True), at


def _moved(x: np.ndarray, every: Sequence[float], offset: float, across: Axis) -> np.ndarray:
    """Positions along an axis, shifted slightly for lines that are side by side."""
    if across.scale == "band":
        return x + offset * STEP_OF_NAMES
    low, high = min(every), max(every)
    moved = x * (high / low) ** (STEP * offset) if across.scale == "log" else x + STEP * offset * (high - low)
    return np.asarray(moved)


def _up(y: str, every: Points, logarithmic: bool | None) -> Axis:
    ends = np.array([end for _, spread in every for end in (spread.low, spread.high)])
    include = (float(ends.min()), float(ends.max())) if len(ends) and np.isfinite(ends).all() else ()
    wide = is_wide(np.array([spread.middle for _, spread in every])) if logarithmic is None else logarithmic
    return metric_axis(y, scale="log" if wide and not is_share(y) else "linear", include=include)


def _short(name: Any) -> str:
    return typeset(f"{name:g}" if isinstance(name, int | float) else str(name))
