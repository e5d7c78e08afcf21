"""A metric against an axis: median and spread over the runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from bench.files.atomic import atomic_path
from bench.studies.sweep.metrics import is_share, what_is_measured
from bench.studies.sweep.summary import Spread, Summary, SummaryPart, rank, summarise_in_parts

MANY_TICKS = 300.0  # ratio of largest to smallest value from which powers of ten are ticks enough
WIDE = 20.0  # ratio of largest to smallest value from which an axis is logarithmic
MOST_BANDS = 2  # more than these hide each other
DODGE = 0.009  # of the axis
COVERAGE = 0.95
COLORS = ("#1f6fb4", "#d1600c", "#2b8a3e", "#a8328e", "#7a5b00", "#00808a", "#c22a2a", "#5a5a5a")


def plot_sweep(
    table: Path, path: Path, x: str, y: str, lines: str | None = None, *, logarithmic: bool | None = None
) -> None:
    """Draw a figure (.png, .svg or .pdf): the median of `y` for each value of `x`, with the middle 90 %.

    Of a share: the mean, with its 95 % interval. lines: an axis with a line for each of its values.
    logarithmic: the axis of y; by default where its values span a wide range.
    Raises BenchError if the table has no such column.
    """
    found = _by_line(summarise_in_parts(table, [x, *([lines] if lines else [])], [y]), y)
    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    axes = figure.add_subplot()
    positions, labels = _positions([value for _, values, _ in found for value in values])
    wide = labels is None and _is_wide(list(positions.values()))
    if labels is not None:
        axes.set_xticks(range(len(labels)), labels, rotation=0 if len(labels) < 6 else 30)
    elif wide:
        axes.set_xscale("log")
        _plain_ticks(axes.xaxis, list(positions.values()))
    style = _Style(share=is_share(y), joined=labels is None, bands=len(found) <= MOST_BANDS)
    for i, (name, values, spreads) in enumerate(found):
        at = np.array([positions[value] for value in values], dtype=float)
        if not style.bands or not style.joined:  # side by side, or their bars would hide each other
            at = _moved(at, list(positions.values()), DODGE * (i - (len(found) - 1) / 2), wide=wide)
        _draw(axes, at, spreads, name, COLORS[i % len(COLORS)], style)
    middles = [spread.median for _, _, spreads in found for spread in spreads]
    if is_share(y):
        axes.axhline(COVERAGE, color="#888888", linewidth=0.8, linestyle="--")
    elif logarithmic or (logarithmic is None and _is_wide(middles)):
        axes.set_yscale("log")
        _plain_ticks(
            axes.yaxis,
            [end for _, _, spreads in found for spread in spreads for end in (spread.low, spread.high)],
        )
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_title(what_is_measured(y), fontsize=9, color="#555555")
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    if lines is not None:
        axes.legend(title=lines, frameon=False, fontsize=8, title_fontsize=8)
    with atomic_path(path) as partial, mpl.rc_context({"svg.hashsalt": "bench", "svg.fonttype": "none"}):
        figure.savefig(partial, dpi=150, metadata={"Date": None} if path.suffix == ".svg" else None)


@dataclass(frozen=True)
class _Style:
    """share: draw the mean; joined: the values of x are numbers; bands: spreads as areas, otherwise as bars."""

    share: bool
    joined: bool
    bands: bool


Found = list[tuple[Any, list[Any], list[Spread]]]
"""For each line: its value, values of x, spreads of y."""


def _by_line(summary: Summary, y: str) -> Found:
    """Rising in x; lines in rising order too, if they are numbers."""
    found: dict[Any, tuple[list[Any], list[Spread]]] = {}
    for line in summary.lines:
        x, *names = line.values
        if x is not None and line.spreads[y].count:
            values, spreads = found.setdefault(names[0] if names else None, ([], []))
            values.append(x.middle if isinstance(x, SummaryPart) else x)
            spreads.append(line.spreads[y])
    return [(name, *found[name]) for name in sorted(found, key=rank)]


def _positions(values: Sequence[Any]) -> tuple[dict[Any, float], list[str] | None]:
    """Where each value lies on the axis, and its labels if the values are no numbers."""
    distinct = list(dict.fromkeys(values))
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in distinct):
        return {value: float(value) for value in distinct}, None
    return {value: float(i) for i, value in enumerate(distinct)}, [str(value) for value in distinct]


def _moved(at: np.ndarray, all_values: Sequence[float], share: float, *, wide: bool) -> np.ndarray:
    """Values moved sideways by a share of the axis."""
    low, high = min(all_values), max(all_values)
    moved = at * (high / low) ** share if wide else at + share * (high - low or 1.0)
    return np.asarray(moved)


def _plain_ticks(axis: Axis, values: Sequence[float]) -> None:
    """Ticks of a logarithmic axis as plain numbers, between the powers of ten only where these are few."""
    known = [value for value in values if np.isfinite(value) and value > 0]
    wide = not known or max(known) / min(known) >= MANY_TICKS
    axis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _draw(
    axes: Axes, at: np.ndarray, spreads: Sequence[Spread], name: Any, color: str, style: _Style
) -> None:
    middle = np.array([spread.mean if style.share else spread.median for spread in spreads])
    low, high = (np.array([getattr(spread, end) for spread in spreads]) for end in ("low", "high"))
    label = None if name is None else str(name)
    if style.bands and style.joined and len(at) > 1:
        axes.fill_between(at, low, high, color=color, alpha=0.13, linewidth=0)
        axes.plot(at, middle, color=color, marker="o", markersize=3.5, linewidth=1.4, label=label)
    else:
        errors = np.maximum(np.stack([middle - low, high - middle]), 0.0)
        line = "-" if style.joined else "none"
        axes.errorbar(
            at,
            middle,
            errors,
            color=color,
            marker="o",
            markersize=3.5,
            linestyle=line,
            linewidth=1.0,
            elinewidth=0.8,
            capsize=2,
            label=label,
        )


def _is_wide(values: Sequence[float]) -> bool:
    known = [value for value in values if np.isfinite(value)]
    return len(known) > 1 and min(known) > 0 and max(known) / min(known) >= WIDE
