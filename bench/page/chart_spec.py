"""Charts as plain data for the page's script, with only the points and digits that are visible."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

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
from bench.page.parts import Figure, PageChart, Variant

DIGITS = 1.0 / 4000.0  # of a curve's extent: finer than a pixel
HEIGHT, TALL = 210, 330  # px, of charts side by side
LINE = 24  # px for each category, if there are many
LONGEST_NAME = 24  # letters of a category in a chart next to others


def rounded(values: np.ndarray, extent: float | None = None) -> list[float | None]:
    """Values (N,) to the digits visible in a figure of this extent (by default the values'); None if not finite."""
    values = np.asarray(values, dtype=float)
    known = values[np.isfinite(values)]
    if extent is None:
        extent = float(np.ptp(known)) if len(known) else 0.0
    extent = extent or float(np.abs(known).max(initial=0.0)) or 1.0
    decimals = int(np.ceil(-np.log10(extent * DIGITS)))
    if decimals > 15:  # tiny: by significant digits
        return significant(values)
    short = np.round(values, decimals)
    return [None if not np.isfinite(v) else int(v) if decimals <= 0 else v for v in (short + 0.0).tolist()]


def significant(values: npt.ArrayLike, digits: int = 5) -> list[float | None]:
    """Values (N,) to some significant digits, for logarithmic axes; None if not finite."""
    numbers = np.asarray(values, dtype=float).tolist()
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in numbers]


def thinned(
    row: np.ndarray, period: float, curves: Mapping[str, np.ndarray], most: int
) -> tuple[dict[str, float], dict[str, list[Any]], int]:
    """Curves over evenly spaced rows, with at most about `most` points each; gaps where rows are missing.

    row (M,): increasing row numbers; period: s between rows; curves: (M,) each. Returns x as {start, step} in seconds,
    the curves' values, and the number of rows that each pair of points represents (1: every row is kept). Each block of
    rows is reduced to its smallest and largest value, in their order, so that no outlier is lost.
    """
    count = int(row[-1] - row[0]) + 1
    start = float(row[0]) * period
    filled = {name: np.full(count, np.nan) for name in curves}
    for name, values in curves.items():
        filled[name][row - row[0]] = values
    if count <= most:
        every = {name: rounded(values) for name, values in filled.items()}
        return {"start": _short(start), "step": _short(period)}, every, 1
    width = -(-2 * count // most)
    kept = {name: rounded(extremes(values, width)) for name, values in filled.items()}
    at = start + period * (width / 4.0 - 0.5)
    return {"start": _short(at), "step": _short(period * width / 2.0)}, kept, width


def extremes(values: np.ndarray, width: int) -> np.ndarray:
    """The smallest and the largest value of every block of `width` values, in the order in which they occur.

    Two values per block, (2 ceil(N / width),); NaN if it has only NaN.
    """
    stretches = -(-len(values) // width)
    padded = np.full(stretches * width, np.nan)
    padded[: len(values)] = values
    blocks = padded.reshape(stretches, width)
    empty = np.isnan(blocks).all(axis=1)
    low_at = np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1)
    high_at = np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    index = np.arange(stretches)
    first, last = np.minimum(low_at, high_at), np.maximum(low_at, high_at)
    pairs = np.column_stack((blocks[index, first], blocks[index, last]))
    pairs[empty] = np.nan
    return pairs.reshape(-1)


def _short(value: float) -> float:
    return float(f"{value:.9g}")


Spec = dict[str, Any]


def chart_figure(
    chart: Chart, height: int, *, least: int | None = None, turned: bool = False, name: str | None = None
) -> Figure:
    """A figure of one chart without choices. name: its title, by default the chart's; others: see `spec_of`."""
    title = typeset(chart.title if name is None else name)
    variant = Variant((PageChart("", "", spec_of(chart, height, least=least, turned=turned)),))
    return Figure(title, typeset(chart.aid), True, (), {"": variant}, ("",))


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
    """A chart for `assets/charts.js`. height, least (width): px; turned: whether names along x are vertical.

    most: points of a curve over evenly spaced x, see `thinned`; longest: letters of a category.
    """
    spec: Spec = {
        "label": typeset(chart.title),
        "height": height,
        "x": _axis(chart.x, None) | _flag("turned", turned),
        "panels": [_panel(panel, chart, most, longest) for panel in chart.panels],
    }
    if least is not None:
        spec["least"] = least
    if chart.legend != "own":
        spec["legend"] = False
    return spec | _flag("shared", chart.legend == "shared")


def rows_a_pair(chart: Chart, most: int) -> int:
    """The number of rows that each pair of points of the longest curve represents; 1: every row is drawn."""
    curves = [entry.x for entry in chart.series if isinstance(entry, Line) and len(entry.x)]
    longest = max((int(_rows(x)[0][-1]) + 1 for x in curves), default=0)
    return 1 if longest <= most else -(-2 * longest // most)


def _panel(panel: Panel, chart: Chart, most: int | None, longest: int | None) -> Spec:
    series = [_named(entry, panel, most) for entry in panel.series]
    spec: Spec = {"y": _axis(panel.y, longest), "series": series}
    return spec if len(chart.panels) == 1 else {"weight": panel.weight, **spec}


def _named(series: Series, panel: Panel, most: int | None) -> Spec:
    curve = _curve(series, panel.y, most) if isinstance(series, Line) else _series(series)
    levels = [other for other in panel.series if isinstance(other, Levels)]
    if series in levels[:-1]:
        curve["texts"] = []  # the texts of two lines would overlap
    return {"role": series.role, "name": typeset(series.name), **curve}


def _axis(axis: Axis, longest: int | None) -> Spec:
    spec: Spec = {"label": typeset(axis.title)}
    if axis.scale != "linear":
        spec["scale"] = axis.scale
    if axis.scale == "band":
        names = [typeset(name) for name in axis.categories]
        most = longest or max(map(len, names), default=0)
        spec["categories"] = [name if len(name) <= most else f"{name[: most - 1]}…" for name in names]
    if axis.domain is not None:
        spec["domain"] = list(axis.domain)
    if axis.include:
        spec["include"] = list(axis.include)
    return spec | _flag("room", axis.room) | _flag("percent", axis.percent)


def _series(series: Series) -> Spec:
    """One series other than a `Line`, without its name and colour."""
    spec: Spec = {}
    match series:
        case Levels():
            spec = {"kind": "line", "marker": True, "x": {"start": 0, "step": 1}}
            spec |= {"y": significant(series.values), "texts": [typeset(text) for text in series.texts]}
        case Band():
            spec = {"kind": "band", "low": _four(series.low), "high": _four(series.high)}
        case Rule():
            spec = {"kind": "rule", "axis": series.axis, "at": _four(series.at)}
            spec |= _flag("dashed", series.dashed)
        case Binned():
            extent = float(np.nanmax(series.high) - np.nanmin(series.low)) or 1.0
            values = {name: getattr(series, name) for name in ("mean", "spread", "low", "high")}
            drawn = {name: rounded(value, extent) for name, value in values.items()}
            spec = {"kind": "bins", "x": rounded(series.center), **drawn}
        case Whiskers():
            spec = {"kind": "bins", "clear": True, "x": significant(series.x), **_pick(series)}
            spec |= {"mean": significant(series.middle), "spread": [0.0] * len(series.x)}
            spec |= _ends(series) | _flag("apart", not series.joined)
        case Spans():
            spec = {"kind": "intervals", "y": series.y.tolist(), "x": significant(series.x), **_ends(series)}
            spec |= {"shift": series.shift} if series.shift else {}
        case Bars():
            spec = {"kind": "hbars", "x": significant(series.x), **_flag("thin", series.thin)}
        case Points():
            spec = {"kind": "points", "x": significant(series.x), "y": significant(series.y)}
        case Stems():
            spec = {"kind": "stems", "x": rounded(series.x), "y": rounded(series.y, 2.0)}
        case Histogram():
            spec = {"kind": "histogram", "edges": significant(series.edges), "y": significant(series.y)}
        case Cells():
            spec = {"kind": "cells", "x": series.x.tolist(), "y": series.y.tolist()}
            spec |= {"share": significant(series.shade, 3), "texts": [typeset(text) for text in series.texts]}
            spec |= _pick(series)
    return spec


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
    """The number of each row, from 0, and the spacing, of rows that are evenly spaced except for gaps."""
    known = x[np.isfinite(x)]
    step = float(np.median(np.diff(known))) if len(known) > 1 else 1.0
    return np.rint((known - known[0]) / step).astype(int), step
