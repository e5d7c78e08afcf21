"""Charts as the page's script draws them: plain data with the digits that an eye sees."""

from functools import singledispatch
from typing import Any

import numpy as np

from bench.document.charts.chart import (
    Axis,
    Band,
    Bars,
    Binned,
    Cells,
    Chart,
    Histogram,
    Levels,
    Line,
    Panel,
    Points,
    Rule,
    Series,
    Spans,
    Stems,
    Whiskers,
)
from bench.document.typeset import typeset
from bench.page.parts import Figure, PageChart, one_figure
from bench.page.thinned import rounded, significant, thinned

HEIGHT, TALL = 210, 330  # px, of charts that stand side by side
LINE = 24  # px for each category, where there are many
LONGEST_NAME = 24  # letters of a category next to others

Spec = dict[str, Any]


def chart_figure(
    chart: Chart, height: int, *, least: int | None = None, turned: bool = False, name: str | None = None
) -> Figure:
    """A figure of one chart without choices. name: its title, that of the chart by default; others: see `spec_of`."""
    return one_figure(
        typeset(chart.title if name is None else name),
        typeset(chart.aid),
        spec_of(chart, height, least=least, turned=turned),
    )


def page_chart(chart: Chart) -> PageChart:
    """One chart of several, with its title and aid."""
    names = chart.y.categories
    height = max(TALL, 70 + LINE * len(names)) if names else HEIGHT
    return PageChart(typeset(chart.title), typeset(chart.aid), spec_of(chart, height, longest=LONGEST_NAME))


def spec_of(
    chart: Chart,
    height: int,
    *,
    least: int | None = None,
    turned: bool = False,
    most: int | None = None,
    longest: int | None = None,
) -> Spec:
    """A figure for `assets/charts.js`. height, least width: px; turned: names along x stand upright.

    most: points of a curve over evenly spaced x, of which extremes are kept; longest: letters of a category.
    """
    x = _axis(chart.x, None)
    spec: Spec = {
        "label": typeset(chart.title),
        "height": height,
        "x": x | ({"turned": True} if turned else {}),
        "panels": [_panel(panel, chart, most, longest) for panel in chart.panels],
    }
    if least is not None:
        spec["least"] = least
    if chart.legend != "own":
        spec["legend"] = False
    if chart.legend == "shared":
        spec["shared"] = True
    return spec


def rows_a_pair(chart: Chart, most: int) -> int:
    """How many rows stand behind two points of the longest curve; 1: every row is drawn."""
    counts = [
        int(_rows(entry.x)[0][-1]) + 1 for entry in chart.series if isinstance(entry, Line) and len(entry.x)
    ]
    longest = max(counts, default=0)
    return 1 if longest <= most else -(-2 * longest // most)


def _panel(panel: Panel, chart: Chart, most: int | None, longest: int | None) -> Spec:
    spec: Spec = {
        "y": _axis(panel.y, longest),
        "series": [_named(entry, panel, most) for entry in panel.series],
    }
    return spec if len(chart.panels) == 1 else {"weight": panel.weight, **spec}


def _named(series: Series, panel: Panel, most: int | None) -> Spec:
    curve = _curve(series, panel.y, most) if isinstance(series, Line) else _series(series)
    if isinstance(series, Levels) and series is not _last_levels(panel):
        curve["texts"] = []  # what is said of two lines would stand on each other
    return {"role": series.role, "name": typeset(series.name), **curve}


def _last_levels(panel: Panel) -> Series:
    return [series for series in panel.series if isinstance(series, Levels)][-1]


def _axis(axis: Axis, longest: int | None) -> Spec:
    spec: Spec = {"label": typeset(axis.title)}
    if axis.scale != "linear":
        spec["scale"] = axis.scale
    if axis.scale == "band":
        spec["categories"] = [_cut(typeset(name), longest) for name in axis.categories]
    if axis.domain is not None:
        spec["domain"] = list(axis.domain)
    if axis.include:
        spec["include"] = list(axis.include)
    for key, given in (("room", axis.room), ("percent", axis.percent)):
        if given:
            spec[key] = True
    return spec


def _cut(name: str, longest: int | None) -> str:
    return name if longest is None or len(name) <= longest else f"{name[: longest - 1]}…"


@singledispatch
def _series(series: Any) -> Spec:
    """One series, except for lines, without its name and colour."""
    raise TypeError(f"{type(series).__name__}: no such series")


@_series.register
def _(series: Levels) -> Spec:
    values = {"x": {"start": 0, "step": 1}, "y": significant(series.values)}
    return {"kind": "line", "marker": True, **values, "texts": [typeset(text) for text in series.texts]}


@_series.register
def _(series: Band) -> Spec:
    return {"kind": "band", "low": _four(series.low), "high": _four(series.high)}


@_series.register
def _(series: Rule) -> Spec:
    return {"kind": "rule", "axis": series.axis, "at": _four(series.at), **_flag("dashed", series.dashed)}


@_series.register
def _(series: Binned) -> Spec:
    extent = float(np.nanmax(series.high) - np.nanmin(series.low)) or 1.0
    values = {name: getattr(series, name) for name in ("mean", "spread", "low", "high")}
    drawn = {name: rounded(value, extent) for name, value in values.items()}
    return {"kind": "bins", "x": rounded(series.center), **drawn}


@_series.register
def _(series: Whiskers) -> Spec:
    spec: Spec = {"kind": "bins", "clear": True, "x": significant(series.x), "spread": [0.0] * len(series.x)}
    spec |= {"mean": significant(series.middle), **_ends(series), **_flag("apart", not series.joined)}
    return spec | _pick(series)


@_series.register
def _(series: Spans) -> Spec:
    spec: Spec = {"kind": "intervals", "y": series.y.tolist(), "x": significant(series.x), **_ends(series)}
    return spec | ({"shift": series.shift} if series.shift else {})


@_series.register
def _(series: Bars) -> Spec:
    return {"kind": "hbars", "x": significant(series.x), **_flag("thin", series.thin)}


@_series.register
def _(series: Points) -> Spec:
    return {"kind": "points", "x": significant(series.x), "y": significant(series.y)}


@_series.register
def _(series: Stems) -> Spec:
    return {"kind": "stems", "x": rounded(series.x), "y": rounded(series.y, 2.0)}


@_series.register
def _(series: Histogram) -> Spec:
    return {"kind": "histogram", "edges": significant(series.edges), "y": significant(series.y)}


@_series.register
def _(series: Cells) -> Spec:
    spec: Spec = {"kind": "cells", "x": series.x.tolist(), "y": series.y.tolist()}
    spec |= {"share": significant(series.shade, 3), "texts": [typeset(text) for text in series.texts]}
    return spec | _pick(series)


def _ends(series: Whiskers | Spans) -> Spec:
    return {"low": significant(series.low), "high": significant(series.high)}


def _pick(series: Whiskers | Cells) -> Spec:
    return {"pick": [dict(chosen) for chosen in series.pick]} if series.pick else {}


def _flag(key: str, given: bool) -> Spec:
    return {key: True} if given else {}


def _four(value: float) -> float:
    return float(f"{value:.4g}")


def _curve(line: Line, y: Axis, most: int | None) -> Spec:
    spec: Spec = {"kind": "line", **_flag("marker", line.markers)}
    if most is None:
        values = significant(line.y, 3) if y.scale == "log" else rounded(line.y)
        return spec | {"x": rounded(line.x), "y": values}
    row, step = _rows(line.x)
    known = np.isfinite(line.x)
    first = round(float(line.x[known][0]) / step) if known.any() else 0
    x, values_of, _ = thinned(row + first, step, {"y": line.y[known]}, most)
    return spec | {"x": x, "y": values_of["y"]}


def _rows(x: np.ndarray) -> tuple[np.ndarray, float]:
    """Number of each row from the first on, of rows that are evenly spaced except for gaps, and the space."""
    known = x[np.isfinite(x)]
    step = float(np.median(np.diff(known))) if len(known) > 1 else 1.0
    return np.rint((known - known[0]) / step).astype(int), step
