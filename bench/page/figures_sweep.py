"""Figures of a sweep: a metric against an axis, and how metrics spread over all runs."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.effects.display_names import begun
from bench.identification.wording import and_list
from bench.page.parts import Chart, Figure, Variant, one_figure
from bench.page.thinned import significant
from bench.page.words import share, short, typeset
from bench.studies.sweep.metrics import is_relative, is_share, metric_of, what_is_measured
from bench.studies.sweep.summary import Spread, spread, summarise
from bench.studies.sweep.table import read_table
from bench.studies.sweep.titles import axis_title, axis_words, metric_title

ROLES = ("one", "two", "three", "four", "five", "six", "seven")
BINS = 12  # a drawn axis, which has a value of its own in every run, is cut into as many parts of equal count
MOST_VALUES = 40
WIDE = 20.0  # ratio of largest to smallest value from which an axis is logarithmic
COVERAGE = 0.95
MOST_LETTERS = 70  # of names side by side below an axis
STEP = 0.008  # between lines, of the axis
STEP_OF_NAMES = 0.1  # the same, of the room of a name
SLABS = 24

Spec = dict[str, Any]
Points = list[tuple[Any, Spread]]


def value_text(metric: str, value: float) -> str:
    """A metric's value as it is set: relative ones in percent."""
    return share(value) if is_relative(metric) else short(value, 3)


def point_label(value: Any) -> str:
    """A value of an axis, as it is set."""
    return short(value, 5) if isinstance(value, float) else str(value)


def metric_label(metric: str) -> str:
    """A metric in words with its unit."""
    unit = "%" if is_relative(metric) else metric_of(metric).unit
    title = begun(metric_title(metric))
    return f"{title} [{unit}]" if unit else title


def plot_figure(table: Path, x: str, y: str, lines: str | None, picked: Collection[str] = ()) -> Figure:
    """Median and spread of a metric against an axis, a line for each value of another one.

    More lines than colours stand beside each other, each in a chart of its own. picked: axes with several
    values, each tried with all of the others: where x and lines are of them, a dot can be clicked for its runs.
    """
    pick = {x, *([lines] if lines else [])} <= set(picked)
    found = _points(table, x, y, lines)
    every = [point for points in found.values() for point in points]
    values = list(dict.fromkeys(value for value, _ in every))
    across, at = _across(x, values)
    up = _up(y, every)
    label = begun(
        f"{metric_title(y)} against {axis_title(x)}" + (f", by {axis_title(lines)}" if lines else "")
    )
    drawn = []
    for i, (name, points) in enumerate(found.items()):
        # lines stand side by side, or their whiskers would hide each other
        beside = i - (len(found) - 1) / 2.0 if len(found) <= len(ROLES) else 0.0
        x_of = _moved([at[value] for value, _ in points], list(at.values()), beside, across)
        line = _line(points, x_of, of_share=is_share(y)) | {"apart": "categories" in across}
        if pick:
            own = {} if lines is None else {lines: point_label(name)}
            line["pick"] = [{x: point_label(value), **own} for value, _ in points]
        drawn.append(line | ({"name": f"{axis_words(lines)} {_short(name)}"} if lines else {}))
    marks = [{"kind": "rule", "role": "noise", "name": "95 %", "at": COVERAGE, "dashed": True}]
    marks = marks if is_share(y) else []
    what = what_is_measured(y)
    reading = (
        "means; whiskers: 95 % intervals." if is_share(y) else "medians; whiskers: the middle 90 % of runs."
    )
    together = [axis_words(axis) for axis in picked if axis not in (x, lines)] if pick else []
    pooled = f" All values together of {and_list(together)}." if together else ""
    aid = typeset(f"{what[:1].upper()}{what[1:]}. Dots: {reading}{pooled}")

    def spec(height: int, series: Sequence[Spec]) -> Spec:
        return {
            "label": label,
            "height": height,
            "x": across,
            "panels": [{"y": up, "series": [*marks, *series]}],
        }

    if len(drawn) <= len(ROLES):
        coloured = [entry | {"role": role} for entry, role in zip(drawn, ROLES, strict=False)]
        return one_figure(label, aid, spec(300 + _turned(across), coloured))
    charts = tuple(
        Chart(
            f"{axis_title(lines or '')} {_short(name)}",
            "",
            spec(200 + _turned(across), [entry | {"role": "one", "name": ""}]),
        )
        for name, entry in zip(found, drawn, strict=True)
    )
    return Figure(label, aid, False, (), {"": Variant(charts)}, ("",))


def _across(x: str, values: Sequence[Any]) -> tuple[Spec, dict[Any, float]]:
    """The axis along which a metric is drawn, and where each value lies on it."""
    axis: Spec
    if not all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        names = [str(value).replace("_", " ") for value in values]
        turned = sum(map(len, names)) > MOST_LETTERS
        axis = {"label": axis_title(x), "scale": "band", "categories": names, "turned": turned}
        return axis, {value: float(i) for i, value in enumerate(values)}
    axis = (
        {"label": axis_title(x), "scale": "log"}
        if _is_wide(values)
        else {"label": axis_title(x), "room": True}
    )
    return axis, {value: float(value) for value in values}


def _turned(across: Spec) -> int:
    """Room below an axis for names that stand upright, px."""
    return 6 * max(map(len, across["categories"])) if across.get("turned") else 0


def _moved(x: Sequence[float], every: Sequence[float], beside: float, across: Spec) -> list[float]:
    """Places along an axis, moved a little for lines that stand beside each other."""
    if "categories" in across:
        return [value + beside * STEP_OF_NAMES for value in x]
    low, high = min(every), max(every)
    if across.get("scale") == "log":
        return [value * (high / low) ** (STEP * beside) for value in x]
    return [value + STEP * beside * (high - low) for value in x]


def _up(y: str, every: Points) -> Spec:
    axis: Spec = {"label": metric_label(y), "percent": is_relative(y)}
    if not is_share(y) and _is_wide([band.median for _, band in every]):
        axis["scale"] = "log"
    ends = [band.low for _, band in every] + [band.high for _, band in every]
    return axis | {"include": [min(ends), max(ends)]} if every and np.isfinite(ends).all() else axis


def _short(value: Any) -> str:
    return typeset(f"{value:g}" if isinstance(value, int | float) else str(value))


def spread_figure(columns: Mapping[str, Sequence[Any]], metrics: Sequence[str]) -> Figure:
    """A histogram of each metric over all runs."""
    charts = []
    for metric in metrics:
        values = np.array([np.nan if v is None else float(v) for v in columns[metric]])
        values = values[np.isfinite(values)]
        counts, edges = np.histogram(values, bins=min(SLABS, max(5, len(values) // 4)))
        bars = {
            "kind": "histogram",
            "role": "after",
            "name": "runs",
            "edges": significant(edges),
            "y": counts.tolist(),
        }
        median = {
            "kind": "rule",
            "role": "modelled",
            "name": "median",
            "axis": "x",
            "at": float(np.median(values)),
        }
        percent = is_relative(metric)
        spec = {
            "label": f"Runs by {metric_title(metric)}",
            "height": 210,
            "x": {"label": metric_label(metric), "percent": percent},
            "panels": [{"y": {"label": "runs", "include": [0]}, "series": [bars, median]}],
        }
        charts.append(Chart(begun(metric_title(metric)), "", spec))
    aid = "How many runs fall where; none is left out."
    return Figure("Histograms", aid, False, (), {"": Variant(tuple(charts))}, ("",))


def _line(points: Points, x: Sequence[float], *, of_share: bool) -> Spec:
    return {
        "kind": "bins",
        "clear": True,
        "x": significant(x),
        "mean": significant([point.mean if of_share else point.median for _, point in points]),
        "spread": [0.0] * len(points),
        "low": significant([point.low for _, point in points]),
        "high": significant([point.high for _, point in points]),
    }


def _points(table: Path, x: str, y: str, lines: str | None) -> dict[Any, Points]:
    """By the value of `lines`: values of x, rising where they are numbers, with the spread of y."""
    columns = read_table(table, [x])
    distinct = set(columns[x]) - {None}
    if len(distinct) > MOST_VALUES and all(isinstance(value, int | float) for value in distinct):
        return _in_bins(table, x, y, lines)
    found: dict[Any, Points] = {}
    for line in summarise(table, [x, *([lines] if lines else [])], [y]).lines:
        if line.values[0] is not None and line.spreads[y].count:
            name = line.values[1] if lines else None
            found.setdefault(name, []).append((line.values[0], line.spreads[y]))
    for points in found.values():
        if all(isinstance(value, int | float) for value, _ in points):
            points.sort(key=lambda point: float(point[0]))
    return found


def _in_bins(table: Path, x: str, y: str, lines: str | None) -> dict[Any, Points]:
    columns = read_table(table, list(dict.fromkeys((x, y, *([lines] if lines else [])))))
    names = columns[lines] if lines else [None] * len(columns[x])
    found: dict[Any, Points] = {}
    for name in dict.fromkeys(names):
        pairs = [
            (a, b)
            for a, b, own in zip(columns[x], columns[y], names, strict=True)
            if own == name and a is not None and b is not None
        ]
        parts = [part for part in np.array_split(np.array(sorted(pairs), dtype=float), BINS) if len(part)]
        found[name] = [(float(np.median(part[:, 0])), spread(y, part[:, 1])) for part in parts]
    return found


def _is_wide(values: Sequence[float]) -> bool:
    known = [value for value in values if np.isfinite(value)]
    return len(known) > 1 and min(known) > 0 and max(known) / min(known) >= WIDE
