"""Figures of a model: the currents of all motors, and the errors of each motor."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.basics.figure_style import DPI, STYLE
from bench.basics.joint_units import drive_unit
from bench.document.charts.currents import currents_chart, fitted_currents_chart
from bench.document.charts.motor import motor_charts
from bench.document.figures.draw import draw
from bench.document.figures.write import write_figures
from bench.document.layout import SCREEN
from bench.document.numbers import USES, error_std, percent
from bench.identification.result import CurrentSeries, Identification, relative_error
from bench.identification.wording import motor_words
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.motor import Compared, MotorSeries, relative_error_of, relative_noise

LEFT, RIGHT, TITLE, FOOT, LEGEND = 1.02, 0.12, 0.36, 0.6, 0.4  # inches around the axes of one recording
UPPER_MARGINS = {"left": 0.085, "right": 0.985, "top": 0.945, "bottom": 0.05, "wspace": 0.36, "hspace": 0.38}
LOWER_MARGINS = {"left": 0.125, "right": 0.985, "top": 0.92, "bottom": 0.18, "wspace": 0.72}


def current_figure(result: Identification) -> Figure:
    """Measured and modelled current of every motor, with the error below; one block for each recording.

    The band around zero is ± one standard deviation of the errors on the fitted recordings; the error has gaps where a
    joint rests.
    """
    joints = list(result.joints)
    spread = error_std(result)
    units = [drive_unit(result.drive_gains[joint].unit) for joint in joints]
    with mpl.rc_context(STYLE):
        blocks = currents_page([trace.name for trace in result.recordings], joints)
        for series in result.recordings:
            block = blocks.of[series.name]
            block[0][0].set_title(_title(series.name, series, relative_error([series])))
            for j, (upper, lower) in enumerate(block):
                chart = fitted_currents_chart(series, j, float(spread[j]), units[j], series.name)
                draw(upper, chart)
                draw(lower, chart, panel=1)
        blocks.label(joints, units, [f"m{unit}" for unit in units])
    return blocks.figure


@dataclass(frozen=True, eq=False)
class Blocks:
    """A page of currents. of: by recording, a pair of axes (current, error) for every motor."""

    figure: Figure
    of: dict[str, list[tuple[Axes, Axes]]]

    def label(self, joints: Sequence[str], units: Sequence[str], error_units: Sequence[str]) -> None:
        """Label the axes and draw one legend, after everything else is drawn."""
        for place, block in enumerate(self.of.values()):
            first = place % SCREEN.recordings == 0
            of_motors = zip(block, joints, units, error_units, strict=True)
            for (upper, lower), joint, unit, error_unit in of_motors:
                upper.set(xlabel="", ylabel=f"{joint} [{unit}]" if first else "")
                lower.set(xlabel="", ylabel=f"error [{error_unit}]" if first else "")
                upper.tick_params(labelbottom=False)
                lower.tick_params(labelbottom=lower is block[-1][1])
            block[-1][1].set_xlabel("time [s]")
            block[-1][1].xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        for block in self.of.values():
            for panel in (panel for pair in block for panel in pair):
                panel.yaxis.set_label_coords(SCREEN.label_at, 0.5)
        upper, lower = next(iter(self.of.values()))[0]
        handles = [*upper.get_lines(), *lower.get_lines(), *lower.patches]
        self.figure.legend(handles=handles, loc="upper center", ncols=len(handles), frameon=False)


def currents_page(names: Sequence[str], joints: Sequence[str]) -> Blocks:
    """Empty axes for recordings, `SCREEN.recordings` in a row, each with all motors one below another.

    A motor has the same scale in all recordings. Call it within `STYLE`.
    """
    names = list(dict.fromkeys(names))
    columns = min(SCREEN.recordings, len(names))
    rows = -(-len(names) // columns)
    # A figure outside pyplot changes no global state and opens no window.
    # Margins are fixed, in inches, as computing them takes longer than drawing.
    block = SCREEN.motor * len(joints) + TITLE + FOOT
    height = rows * block + LEGEND
    figure = Figure(figsize=(SCREEN.width, height), dpi=DPI)
    width = SCREEN.width / columns
    of: dict[str, list[tuple[Axes, Axes]]] = {}
    first: list[Axes] = []
    for place, name in enumerate(names):
        row, column = divmod(place, columns)
        top = height - LEGEND - row * block
        grid = figure.add_gridspec(
            2 * len(joints),
            1,
            height_ratios=[2.2, 1.0] * len(joints),
            left=(column * width + LEFT) / SCREEN.width,
            right=((column + 1) * width - RIGHT) / SCREEN.width,
            top=(top - TITLE) / height,
            bottom=(top - block + FOOT) / height,
            hspace=0.18,
        )
        axes: list[Axes] = []
        for k in range(2 * len(joints)):
            shared = {"sharex": axes[0] if axes else None, "sharey": first[k] if first else None}
            axes.append(figure.add_subplot(grid[k], **shared))
        first = first or axes
        of[name] = list(zip(axes[::2], axes[1::2], strict=True))
    return Blocks(figure, of)


def _title(name: str, series: CurrentSeries | MotorSeries, error: float | None) -> str:
    load = f", payload {series.payload}" if series.payload else ""
    return f"{name}, {USES[series.use]}{load}: error {percent(error)}"


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
    """Write currents.png and errors_MOTOR.png into a folder, each whole or not at all; return their paths."""
    return write_figures(folder, {"currents.png": currents_figure(what)} | errors_figures(what))


def errors_figures(what: Compared) -> dict[str, Figure]:
    """The page of errors of every motor that moves, by file name."""
    return {f"errors_{joint}.png": errors_figure(what, joint) for joint in what.joints if what.of(joint)}


def currents_figure(what: Compared) -> Figure:
    """Measured and modelled current of every motor, with the error below; a block for each recording."""
    with mpl.rc_context(STYLE):
        blocks = currents_page([trace.recording for trace in what.series], what.joints)
        for trace in what.series:
            upper, lower = blocks.of[trace.recording][what.joints.index(trace.joint)]
            chart = currents_chart([("error", "", trace)], what.units[trace.joint][0], trace.recording)
            draw(upper, chart)
            draw(lower, chart, panel=1)
        for name, block in blocks.of.items():
            motors = [trace for trace in what.series if trace.recording == name]
            block[0][0].set_title(_title(name, motors[0], relative_error_of(motors)))
        units = [what.units[joint][0] for joint in what.joints]
        blocks.label(what.joints, units, units)
    return blocks.figure


def errors_figure(what: Compared, joint: str) -> Figure:
    """One motor's error against the variables on which it may depend; all recordings together.

    Points are single rows (a regular selection, and all distant ones), lines the means of bins with equally many rows,
    bands their standard deviations, separately for each direction of motion.
    """
    errors = error_breakdown(what, joint)
    with mpl.rc_context(STYLE):
        # Margins are fixed, as computing them takes longer than drawing. The lower charts have names next to their
        # bars: in a separate subfigure these take no space from the columns above.
        figure = Figure(figsize=(SCREEN.width, 12.0), dpi=DPI)
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=[3.1, 1.0]).ravel()
        rows = upper.subplots(3, 3, gridspec_kw=UPPER_MARGINS)
        axes = np.concatenate((rows, lower.subplots(1, 3, squeeze=False, gridspec_kw=LOWER_MARGINS)))
        charts = motor_charts(errors)
        for place, name in zip(axes.flat, SHOWN, strict=True):
            draw(place, charts[name], letters=SCREEN.letters)
        handles, names = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, names, loc="upper right", ncols=len(names), frameon=False)
        error, noise = relative_error_of(errors.series), relative_noise(errors.series)
        size = f"error {percent(error)} of the current, noise {percent(noise)}"
        figure.suptitle(f"{what.robot}, {motor_words(joint)}: {size}", x=0.01, y=0.99, ha="left", fontsize=12)
    return figure
