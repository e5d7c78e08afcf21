"""Where a model fails, as pictures: the currents of all motors, and a page of errors for each motor."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.compare.motor import Compared, MotorSeries, relative_error_of, relative_noise
from bench.compare.profile import Variable
from bench.compare.regions import regions
from bench.files import atomic_path
from bench.show.colours import ON_WHITE
from bench.show.comparison_panels import (
    NOISE,
    draw_against,
    draw_around_reversals,
    draw_autocorrelation,
    draw_opposing,
    draw_position_spectrum,
    draw_recordings,
    draw_shares,
    draw_time_spectrum,
)
from bench.show.figures import COLUMN_WIDTH, DPI, LEAST_WIDTH, MOTOR_HEIGHT, STYLE
from bench.show.numbers import USES, percent

OWN_PANELS = ("recording", "with")  # regions that are drawn by recording


def write_comparison_figures(folder: Path, what: Compared) -> list[Path]:
    """Write currents.png and errors_MOTOR.png into a folder, each whole or not at all, and tell their paths."""
    pages = {"currents.png": currents_figure(what)}
    pages |= {f"errors_{joint}.png": errors_figure(what, joint) for joint in what.joints if what.of(joint)}
    for name, figure in pages.items():
        with atomic_path(folder / name) as partial:
            figure.savefig(partial)
    return [folder / name for name in pages]


def currents_figure(what: Compared) -> Figure:
    """Measured and modelled current of every motor with the error below; a column for each recording."""
    names = list(dict.fromkeys(one.recording for one in what.series))
    with mpl.rc_context(STYLE):
        size = (max(COLUMN_WIDTH * len(names), LEAST_WIDTH), MOTOR_HEIGHT * len(what.joints) + 0.9)
        figure = Figure(figsize=size, dpi=DPI, layout="constrained")
        axes = figure.subplots(
            2 * len(what.joints),
            len(names),
            sharex="col",
            sharey="row",
            squeeze=False,
            height_ratios=[2.2, 1.0] * len(what.joints),
        )
        for one in what.series:
            row, column = 2 * what.joints.index(one.joint), names.index(one.recording)
            _draw_currents(axes[row, column], one)
            _draw_error(axes[row + 1, column], one)
        for column, name in enumerate(names):
            axes[0, column].set_title(_title([one for one in what.series if one.recording == name]))
            axes[-1, column].set_xlabel("time [s]")
            axes[-1, column].xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        for j, joint in enumerate(what.joints):
            unit = what.units[joint][0]
            axes[2 * j, 0].set_ylabel(f"{joint} [{unit}]")
            axes[2 * j + 1, 0].set_ylabel(f"error [{unit}]")
        figure.align_ylabels()
        handles = [*axes[0, 0].get_lines(), *axes[1, 0].get_lines(), *axes[1, 0].patches]
        figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), frameon=False)
    return figure


def errors_figure(what: Compared, joint: str) -> Figure:
    """One motor's error against everything that it may depend on; all recordings together.

    Points are single rows (at most 2500 are drawn), lines the means of bins with equally many rows, bands their
    standard deviations, apart for either direction of motion.
    """
    series = what.of(joint)
    current, unit = what.units[joint]
    found = [one for one in regions(series, unit, current) if not one.name.startswith(OWN_PANELS)]
    labels: dict[Variable, str] = {
        "time": "time from the start of the recording [s]",
        "position": f"position [{unit}]",
        "velocity": f"velocity [{unit}/s]",
        "acceleration": f"acceleration [{unit}/s²]",
        "current": f"modelled current [{current}]",
    }
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(16.5, 9.4), dpi=DPI, layout="constrained")
        axes = figure.subplots(3, 4)
        for place, (variable, label) in zip(axes.flat, labels.items(), strict=False):
            draw_against(place, series, variable)
            place.set(xlabel=label, ylabel=f"error [{current}]")
        draw_around_reversals(axes[1, 1], series)
        axes[1, 1].set(xlabel="time from the nearest reversal [s]", ylabel=f"error [{current}]")
        draw_shares(axes[1, 2], series, found)
        axes[1, 2].set(xlabel="share of the squared error [%]")
        draw_recordings(axes[1, 3], series)
        axes[1, 3].set(xlabel="error of the current [%]")
        draw_time_spectrum(axes[2, 0], series)
        axes[2, 0].set(xlabel="frequency [Hz]", ylabel=f"density of the error [{current}²/Hz]")
        draw_position_spectrum(axes[2, 1], series)
        axes[2, 1].set(xlabel=f"cycles per {unit}", ylabel=f"amplitude of the error [{current}]")
        draw_autocorrelation(axes[2, 2], series)
        axes[2, 2].set(xlabel="lag [s]", ylabel="autocorrelation of the error")
        draw_opposing(axes[2, 3], series)
        axes[2, 3].set(xlabel=f"error that opposes the motion [{current}]")
        handles, names = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper right", ncols=len(names), frameon=False)
        error, noise = relative_error_of(series), relative_noise(series)
        figure.suptitle(
            f"{what.robot}, motor {joint}: error {percent(error)} of the current, noise {percent(noise)}",
            x=0.01,
            ha="left",
            fontsize=11,
        )
    return figure


def _title(series: Sequence[MotorSeries]) -> str:
    one = series[0]
    load = f", payload {one.payload}" if one.payload else ""
    return f"{one.recording}, {USES[one.use]}{load}: error {percent(relative_error_of(series))}"


def _draw_currents(axes: Axes, one: MotorSeries) -> None:
    time = _with_gaps(one, one.time)
    axes.plot(
        time,
        _with_gaps(one, one.measured),
        color=ON_WHITE.measured,
        linewidth=3.2,
        alpha=0.45,
        label="measured",
    )
    axes.plot(time, _with_gaps(one, one.modelled), color=ON_WHITE.modelled, linewidth=1.1, label="modelled")
    axes.margins(x=0.01)


def _draw_error(axes: Axes, one: MotorSeries) -> None:
    axes.axhspan(
        -one.noise, one.noise, color=NOISE, alpha=0.45, linewidth=0.0, label="± noise of the current"
    )
    axes.plot(
        _with_gaps(one, one.time),
        _with_gaps(one, one.error),
        color=ON_WHITE.error,
        linewidth=0.8,
        label="error",
    )
    axes.margins(x=0.01)


def _with_gaps(one: MotorSeries, values: np.ndarray) -> np.ndarray:
    """Values with NaN where rows are missing, so that no line is drawn across."""
    return np.asarray(np.insert(values, np.flatnonzero(np.diff(one.row) > 1) + 1, np.nan))
