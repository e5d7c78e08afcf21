"""Where a model fails, as pictures: the currents of all motors, and a page of errors for each motor."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from bench.basics.figure_style import DPI, STYLE
from bench.basics.files.atomic import atomic_path
from bench.document.charts.currents import currents_chart
from bench.document.charts.motor import motor_charts
from bench.document.figures.currents import currents_page
from bench.document.figures.draw import draw
from bench.document.layout import SCREEN
from bench.document.numbers import USES, percent
from bench.identification.wording import motor_words
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.motor import Compared, MotorSeries, relative_error_of, relative_noise

UPPER_MARGINS = {"left": 0.085, "right": 0.985, "top": 0.945, "bottom": 0.05, "wspace": 0.36, "hspace": 0.38}
LOWER_MARGINS = {"left": 0.125, "right": 0.985, "top": 0.92, "bottom": 0.18, "wspace": 0.72}
SHOWN = (
    "time",
    "position",
    "velocity",
    "acceleration",
    "current",
    "reversals",
    "spectrum",
    "positions",
    "autocorrelation",
    "shares",
    "recordings",
    "opposing",
)


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
    with mpl.rc_context(STYLE):
        blocks = currents_page([trace.recording for trace in what.series], what.joints)
        for trace in what.series:
            upper, lower = blocks.of[trace.recording][what.joints.index(trace.joint)]
            chart = currents_chart([("error", "", trace)], what.units[trace.joint][0], trace.recording)
            draw(upper, chart)
            draw(lower, chart, panel=1)
        for name, block in blocks.of.items():
            block[0][0].set_title(
                _title([motor_trace for motor_trace in what.series if motor_trace.recording == name])
            )
        units = [what.units[joint][0] for joint in what.joints]
        blocks.label(what.joints, units, units)
    return blocks.figure


def errors_figure(what: Compared, joint: str) -> Figure:
    """One motor's error against everything that it may depend on; all recordings together.

    Points are single rows (a regular choice, and every one far off), lines the means of bins with equally many
    rows, bands their standard deviations, apart for either direction of motion.
    """
    errors = error_breakdown(what, joint)
    with mpl.rc_context(STYLE):
        # Margins are given: working them out takes longer than drawing. Names stand at the bars below: kept apart,
        # they take no room from the columns above.
        figure = Figure(figsize=(SCREEN.width, 12.0), dpi=DPI)
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=[3.1, 1.0]).ravel()
        axes = np.concatenate(
            (
                upper.subplots(3, 3, gridspec_kw=UPPER_MARGINS),
                lower.subplots(1, 3, squeeze=False, gridspec_kw=LOWER_MARGINS),
            )
        )
        charts = motor_charts(errors)
        for place, name in zip(axes.flat, SHOWN, strict=True):
            draw(place, charts[name], letters=SCREEN.letters)
        handles, names = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, names, loc="upper right", ncols=len(names), frameon=False)
        error, noise = relative_error_of(errors.series), relative_noise(errors.series)
        figure.suptitle(
            f"{what.robot}, {motor_words(joint)}: error {percent(error)} of the current, noise {percent(noise)}",
            x=0.01,
            y=0.99,
            ha="left",
            fontsize=12,
        )
    return figure


def _title(series: Sequence[MotorSeries]) -> str:
    first = series[0]
    load = f", payload {first.payload}" if first.payload else ""
    return f"{first.recording}, {USES[first.use]}{load}: error {percent(relative_error_of(series))}"
