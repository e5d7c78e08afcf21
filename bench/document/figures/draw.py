"""Charts drawn with matplotlib: one panel of a chart into one Axes."""

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis as DrawnAxis
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

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
    Role,
    Rule,
    Spans,
    Stems,
    Whiskers,
)
from bench.document.colours import ON_WHITE
from bench.document.layout import SCREEN

Look = dict[str, Any]  # matplotlib types every keyword by its name

COLOURS: Mapping[Role, str] = {  # after Okabe and Ito
    "measured": ON_WHITE.measured,
    "modelled": ON_WHITE.modelled,
    "error": ON_WHITE.error,
    "before": "#D55E00",
    "after": "#0072B2",
    "noise": "#9AA0A6",
    "forwards": "#0072B2",
    "backwards": "#D55E00",
    "one": "#1f6fb4",
    "two": "#d1600c",
    "three": "#2b8a3e",
    "four": "#a8328e",
    "five": "#7a5b00",
    "six": "#00808a",
    "seven": "#c22a2a",
}
WIDTHS: Mapping[Role, float] = {
    "measured": 3.2,
    "modelled": 1.1,
    "error": 0.9,
    "before": 2.2,
    "after": 0.8,
    "noise": 1.3,
}
PALE: Mapping[Role, float] = {"measured": 0.45, "before": 0.5}  # opacity of broad lines below others
MARKS: Mapping[Role, str] = {"before": "s"}
ZERO = "#8A929C"
DARK = "#3A424C"
BAND_COLOURS: Mapping[Role, str] = {"error": ON_WHITE.band}
PLAIN = FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−"))


@dataclass(frozen=True)
class Pen:
    """How all series of a panel are drawn. scale: of lines and markers; x, y: factors, 100 for shares in percent."""

    axes: Axes
    scale: float
    x: float
    y: float


def draw(
    axes: Axes,
    chart: Chart,
    scale: float = 1.0,
    *,
    panel: int = 0,
    key: bool = True,
    letters: int | None = None,
) -> None:
    """Draw one panel of a chart and label its axes. key: whether the chart's key is shown above it.

    letters: of a line of a category's name; longer names are broken into two lines.
    """
    what = chart.panels[panel]
    pen = Pen(axes, scale, 100.0 if chart.x.percent else 1.0, 100.0 if what.y.percent else 1.0)
    if levels := [series for series in what.series if isinstance(series, Levels)]:
        _draw_levels(pen, levels, what, chart.x)
    else:
        for series in what.series:
            _draw(series, pen)
        if binned := [series for series in what.series if isinstance(series, Binned)]:
            _keep_errors_in_view(pen, binned)
        _set_axis(axes, axes.xaxis, chart.x, letters)
        _set_axis(axes, axes.yaxis, what.y, letters)
    if any(isinstance(series, Line) for series in what.series) and chart.x.scale == "linear":
        axes.margins(x=0.01)
    if key and chart.key:
        size = 0.85 * float(mpl.rcParams["font.size"])
        axes.set_title(chart.key, fontsize=size, color="#4A525C", loc="right")


def points_of(series: Binned) -> np.ndarray:
    """Indices of rows to draw as points on the screen and in print; see `worth_drawing`."""
    return worth_drawing(series, SCREEN.points)


def worth_drawing(series: Binned, most: int) -> np.ndarray:
    """Indices of rows to draw as points: a regular selection of about `most`, and all far from their bin's mean."""
    size = len(series.mean)
    index = np.clip(np.searchsorted(series.edges, series.x, side="right") - 1, 0, size - 1)
    mean, spread = np.nan_to_num(series.mean)[index], np.nan_to_num(series.spread)[index]
    far = np.abs(series.y - mean) > SCREEN.distant * spread
    far |= (series.y == series.y.max()) | (series.y == series.y.min())
    every = max(1, -(-len(series.x) // most))
    return np.flatnonzero(far | (np.arange(len(series.x)) % every == 0))


@singledispatch
def _draw(series: Any, pen: Pen) -> None:
    raise TypeError(f"{type(series).__name__}: cannot be drawn into {pen.axes}")


@_draw.register
def _(line: Line, pen: Pen) -> None:
    (drawn,) = pen.axes.plot(
        pen.x * line.x,
        pen.y * line.y,
        color="#5A6470" if line.role == "noise" else COLOURS[line.role],
        linewidth=WIDTHS.get(line.role, 1.4) * pen.scale,
        alpha=PALE.get(line.role, 1.0),
        label=line.name,
    )
    if line.markers:
        drawn.set(marker=".", markersize=2.5 * pen.scale)


@_draw.register
def _(band: Band, pen: Pen) -> None:
    colour = BAND_COLOURS.get(band.role, COLOURS[band.role])
    span = pen.axes.axhspan(band.low, band.high, color=colour, alpha=0.45, linewidth=0.0)
    span.set_label(band.name)


@_draw.register
def _(rule: Rule, pen: Pen) -> None:
    named = bool(rule.name) and not rule.dashed
    style: Look = {
        "color": COLOURS[rule.role] if named else ZERO,
        "linewidth": (3.0 if named else 0.8) * pen.scale,
        "alpha": 0.6 if named else 1.0,
        "linestyle": "--" if rule.name and rule.dashed else "-",
    }
    line = pen.axes.axvline(pen.x * rule.at) if rule.axis == "x" else pen.axes.axhline(pen.y * rule.at)
    line.set(**style, label=rule.name or "_")


@_draw.register
def _(series: Binned, pen: Pen) -> None:
    """Points, means of bins, and their spread as a band."""
    colour, drawn = COLOURS[series.role], points_of(series)
    dots: Look = {"color": colour, "markersize": 1.8 * pen.scale, "alpha": 0.3, "rasterized": True}
    pen.axes.plot(series.x[drawn], series.y[drawn], ".", **dots)
    low, high = series.mean - series.spread, series.mean + series.spread
    pen.axes.fill_between(series.center, low, high, color=colour, alpha=0.16, linewidth=0.0)
    means: Look = {"color": colour, "linewidth": 1.6 * pen.scale, "markersize": 3.2 * pen.scale}
    pen.axes.plot(series.center, series.mean, label=series.name, marker="o", **means)


def _keep_errors_in_view(pen: Pen, binned: Sequence[Binned]) -> None:
    """Choose limits that show all errors, except single distant ones, which are marked at the border."""
    drawn = [points_of(series) for series in binned]
    errors = np.abs(np.concatenate([series.y[rows] for series, rows in zip(binned, drawn, strict=True)]))
    most, largest = float(np.percentile(errors, SCREEN.percentile)), float(errors.max())
    reach = 1.08 * min(largest, SCREEN.reach * most) or 1.0
    pen.axes.set_ylim(-reach, reach)
    for series, rows in zip(binned, drawn, strict=True):
        for sign, marker in ((1.0, 6), (-1.0, 7)):  # carets that point out of the axes
            out = sign * series.y[rows] > reach
            if out.any():
                border = np.full(int(out.sum()), sign * 0.99 * reach)
                look: Look = {"color": COLOURS[series.role], "markersize": 4.0 * pen.scale, "clip_on": False}
                pen.axes.plot(series.x[rows][out], border, linestyle="none", marker=marker, **look)


@_draw.register
def _(series: Whiskers, pen: Pen) -> None:
    middle, low, high = (pen.y * values for values in (series.middle, series.low, series.high))
    pen.axes.errorbar(
        pen.x * series.x,
        middle,
        np.maximum(np.stack([middle - low, high - middle]), 0.0),
        color=COLOURS[series.role],
        marker="o",
        markersize=3.5 * pen.scale,
        linestyle="-" if series.joined else "none",
        linewidth=1.0 * pen.scale,
        elinewidth=0.8 * pen.scale,
        capsize=2.0 * pen.scale,
        label=series.name or None,
    )


@_draw.register
def _(series: Spans, pen: Pen) -> None:
    x, low, high = (pen.x * values for values in (series.x, series.low, series.high))
    pen.axes.errorbar(
        x,
        series.y + series.shift,
        xerr=np.nan_to_num(np.maximum(np.stack([x - low, high - x]), 0.0)),
        fmt=MARKS.get(series.role, "o"),
        color=COLOURS[series.role],
        markersize=4.5 * pen.scale,
        capsize=2.5 * pen.scale,
        linewidth=1.3 * pen.scale,
        label=series.name,
    )


@_draw.register
def _(series: Bars, pen: Pen) -> None:
    height, alpha = (0.8, 0.75) if series.thin else (0.55, 1.0)
    at, colour = np.arange(len(series.x)), COLOURS[series.role]
    pen.axes.barh(at, pen.x * series.x, height, color=colour, alpha=alpha, label=series.name)


@_draw.register
def _(series: Points, pen: Pen) -> None:
    dots: Look = {"markersize": 3.5 * pen.scale, "color": COLOURS[series.role], "alpha": 0.7}
    pen.axes.plot(pen.x * series.x, pen.y * series.y, "o", label=series.name, **dots)


@_draw.register
def _(series: Stems, pen: Pen) -> None:
    colour = COLOURS[series.role]
    pen.axes.vlines(series.x, 0.0, series.y, color=colour, linewidth=pen.scale)
    pen.axes.plot(series.x, series.y, "o", color=colour, markersize=2.5 * pen.scale, label=series.name)


@_draw.register
def _(series: Histogram, pen: Pen) -> None:
    look: Look = {"fill": True, "color": COLOURS[series.role], "alpha": 0.75, "label": series.name}
    pen.axes.stairs(pen.y * series.y, series.edges, **look)


@_draw.register
def _(series: Cells, pen: Pen) -> None:
    shades = np.full((int(series.y.max()) + 1, int(series.x.max()) + 1), np.nan)
    shades[series.y, series.x] = series.shade
    pen.axes.imshow(np.nan_to_num(shades), cmap="Blues", vmin=0.0, vmax=1.0, aspect="equal")
    for x, y, shade, text in zip(series.x, series.y, series.shade, series.texts, strict=True):
        colour = "white" if shade > 0.6 else "black"
        pen.axes.text(x, y, text, ha="center", va="center", fontsize=6.5, color=colour)
    for axis, count in ((pen.axes.xaxis, shades.shape[1]), (pen.axes.yaxis, shades.shape[0])):
        axis.set_ticks(np.arange(count + 1) - 0.5, minor=True)
    pen.axes.grid(visible=False, which="major")
    pen.axes.grid(which="minor", color="#E6E9ED", linewidth=0.6)
    pen.axes.tick_params(which="both", length=0)


def _draw_levels(pen: Pen, levels: Sequence[Levels], panel: Panel, x: Axis) -> None:
    """Horizontal bars from zero, one row per category; rules of y are vertical."""
    scale = pen.scale
    for i, series in enumerate(levels):
        places = np.arange(len(series.values)) + SCREEN.bar * (i - (len(levels) - 1) / 2.0)
        known = np.isfinite(series.values)
        sizes = pen.y * series.values[known]
        look: Look = {"color": COLOURS[series.role], "alpha": PALE.get(series.role, 1.0)}
        bars = pen.axes.barh(places[known], sizes, SCREEN.bar, label=series.name, **look)
        if series.texts:
            texts = [text for text, there in zip(series.texts, known, strict=True) if there]
            pen.axes.bar_label(bars, texts, padding=4 * scale, color=DARK)
    for rule in (series for series in panel.series if isinstance(series, Rule)):
        line = pen.axes.axvline(pen.y * rule.at, color=COLOURS[rule.role], linewidth=2.4 * scale)
        line.set_label(rule.name)
    pen.axes.set_yticks(np.arange(len(x.categories)), x.categories)
    pen.axes.set_ylim(len(x.categories) - 0.4, -0.6)
    pen.axes.set_xlim(0.0, 1.18 * pen.y * max(float(np.nanmax(series.values)) for series in levels))
    pen.axes.set_xlabel(panel.y.title)
    pen.axes.grid(visible=False, axis="y")


def _set_axis(axes: Axes, drawn: DrawnAxis, axis: Axis, letters: int | None) -> None:
    upright = drawn is axes.yaxis
    (axes.set_ylabel if upright else axes.set_xlabel)(axis.title)
    limits = axes.set_ylim if upright else axes.set_xlim
    if axis.scale == "band":
        names = [_in_lines(name, letters) for name in axis.categories]
        drawn.set_ticks(np.arange(len(names)), names)
        limits(*((len(names) - 0.4, -0.6) if upright else (-0.5, len(names) - 0.5)))
        return
    factor = 100.0 if axis.percent else 1.0
    if axis.scale == "log":
        (axes.set_yscale if upright else axes.set_xscale)("log")
    elif axis.room:
        drawn.set_major_locator(MaxNLocator("auto" if upright else 3))
        drawn.set_major_formatter(PLAIN)
    if axis.domain is not None:
        limits(factor * axis.domain[0], factor * axis.domain[1])
    elif axis.include:
        low, high = axes.get_ylim() if upright else axes.get_xlim()
        wanted = [factor * value for value in axis.include]
        smallest = min(wanted)
        # an axis that begins at zero has no space below it
        at_zero = smallest == 0.0 and low > -0.1 * (high - low)
        limits(0.0 if at_zero else min(low, smallest), max(high, *wanted))
    if axis.scale == "log":
        _plain_ticks(drawn)


def _plain_ticks(drawn: DrawnAxis) -> None:
    """Ticks of a logarithmic axis; over few decades as plain numbers, also between the powers of ten."""
    low, high = drawn.get_view_interval()
    wide = low <= 0 or high >= SCREEN.decades * low
    drawn.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    if not wide:
        drawn.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    drawn.set_minor_formatter(NullFormatter())


def _in_lines(name: str, letters: int | None) -> str:
    if letters is None or len(name) <= letters:
        return name
    lines = textwrap.wrap(name, letters, break_long_words=False)[:2]
    return "\n".join(shortened(line, letters) for line in lines)


def shortened(name: str, most: int) -> str:
    """A name of at most `most` letters; a long one has an ellipsis in the middle."""
    half = (most - 1) // 2
    return name if len(name) <= most else f"{name[: most - 1 - half]}…{name[-half:]}"
