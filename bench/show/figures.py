"""Measured and modelled currents as pictures."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.errors import BenchError
from bench.estimate.result import CurrentSeries, Identification, relative_error
from bench.files import atomic_path
from bench.show.colours import ON_WHITE
from bench.show.numbers import USES, current_unit, error_deviation, judged_error, percent

COLUMN_WIDTH, LEAST_WIDTH = 5.2, 9.0  # inches
MOTOR_HEIGHT = 2.3  # inches
DPI = 130
# Any: matplotlib types every key of these by name.
STYLE: Any = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E6E9ED",
    "grid.linewidth": 0.6,
    "axes.edgecolor": "#8A929C",
    "axes.labelcolor": "#3A424C",
    "xtick.color": "#4A525C",
    "ytick.color": "#4A525C",
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
}


def current_figure(result: Identification, recordings: Sequence[str] | None = None) -> Figure:
    """Measured and modelled current of every motor, the error below; one column for each recording.

    recordings: names of those to show, all by default. The band about the error is one standard deviation
    of the errors on the fitted recordings; the error has gaps where a joint stands still. Raises BenchError
    for a recording that the result does not have.
    """
    chosen = _chosen(result, recordings)
    joints = list(result.drive_gains)
    spread = error_deviation(result)
    with mpl.rc_context(STYLE):
        # A figure outside pyplot: nothing global is touched, and no window can open.
        size = (max(COLUMN_WIDTH * len(chosen), LEAST_WIDTH), MOTOR_HEIGHT * len(joints) + 0.9)
        figure = Figure(figsize=size, dpi=DPI, layout="constrained")
        axes = figure.subplots(
            2 * len(joints),
            len(chosen),
            sharex="col",
            sharey="row",
            squeeze=False,
            height_ratios=[2.2, 1.0] * len(joints),
        )
        for column, series in enumerate(chosen):
            axes[0, column].set_title(_title(series))
            for j in range(len(joints)):
                upper, lower = axes[2 * j, column], axes[2 * j + 1, column]
                _draw_currents(upper, series, j)
                _draw_error(lower, series, j, float(spread[j]))
            axes[-1, column].set_xlabel("time [s]")
            axes[-1, column].xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        for j, (joint, gain) in enumerate(result.drive_gains.items()):
            unit = current_unit(gain.unit)
            axes[2 * j, 0].set_ylabel(f"{joint} [{unit}]")
            axes[2 * j + 1, 0].set_ylabel(f"error [m{unit}]")
        figure.align_ylabels()
        handles = [*axes[0, 0].get_lines(), *axes[1, 0].get_lines(), *axes[1, 0].patches]
        figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), frameon=False)
    return figure


def write_current_figure(
    path: str | Path, result: Identification, recordings: Sequence[str] | None = None
) -> None:
    """Write `current_figure` as a picture, PNG or SVG by suffix, whole or not at all."""
    figure = current_figure(result, recordings)
    with atomic_path(path) as partial:
        figure.savefig(partial)


def _chosen(result: Identification, names: Sequence[str] | None) -> list[CurrentSeries]:
    by_name = {one.name: one for one in result.recordings}
    for name in names or ():
        if name not in by_name:
            raise BenchError(f"no recording {name!r}; there are: {', '.join(by_name)}")
    return [by_name[name] for name in (by_name if names is None else names)]


def _title(series: CurrentSeries) -> str:
    load = f", payload {series.payload}" if series.payload else ""
    return f"{series.name}, {USES[series.use]}{load}: error {percent(relative_error([series]))}"


def _draw_currents(axes: Axes, series: CurrentSeries, motor: int) -> None:
    time = series.time - series.time[0]
    axes.plot(
        time, series.measured[:, motor], color=ON_WHITE.measured, linewidth=3.2, alpha=0.45, label="measured"
    )
    axes.plot(time, series.modelled[:, motor], color=ON_WHITE.modelled, linewidth=1.1, label="modelled")
    axes.margins(x=0.01)


def _draw_error(axes: Axes, series: CurrentSeries, motor: int, spread: float) -> None:
    time = series.time - series.time[0]
    axes.axhspan(
        -1e3 * spread,
        1e3 * spread,
        color=ON_WHITE.band,
        alpha=0.35,
        linewidth=0.0,
        label="± one deviation of the fitted errors",
    )
    axes.plot(time, 1e3 * judged_error(series)[:, motor], color=ON_WHITE.error, linewidth=0.8, label="error")
    axes.margins(x=0.01)
