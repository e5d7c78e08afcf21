"""Where a model fails, as pictures: the currents of all motors, and a page of errors for each motor."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.document.colours import ON_WHITE
from bench.document.figures.comparison_panels import (
    draw_against,
    draw_around_reversals,
    draw_autocorrelation,
    draw_noise_band,
    draw_opposing,
    draw_position_spectrum,
    draw_recordings,
    draw_shares,
    draw_time_spectrum,
    small_title,
)
from bench.document.figures.currents import DPI, PAGE_WIDTH, STYLE, currents_page
from bench.document.numbers import USES, percent
from bench.files.atomic import atomic_path
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.motor import Compared, MotorSeries, relative_error_of, relative_noise
from bench.residuals.words import motor_words

UPPER_MARGINS = {"left": 0.085, "right": 0.985, "top": 0.945, "bottom": 0.05, "wspace": 0.36, "hspace": 0.38}
LOWER_MARGINS = {"left": 0.125, "right": 0.985, "top": 0.92, "bottom": 0.18, "wspace": 0.72}


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
            _draw_currents(upper, trace)
            _draw_error(lower, trace)
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
    current, unit = errors.current, errors.unit
    with mpl.rc_context(STYLE):
        # Margins are given: working them out takes longer than drawing. Names stand at the bars below: kept apart,
        # they take no room from the columns above.
        figure = Figure(figsize=(PAGE_WIDTH, 12.0), dpi=DPI)
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=[3.1, 1.0]).ravel()
        axes = np.concatenate(
            (
                upper.subplots(3, 3, gridspec_kw=UPPER_MARGINS),
                lower.subplots(1, 3, squeeze=False, gridspec_kw=LOWER_MARGINS),
            )
        )
        for place, (variable, label) in zip(axes.flat, errors.labels.items(), strict=False):
            draw_against(place, errors, variable)
            place.set(xlabel=label, ylabel=f"error [{current}]")
        rest = iter(axes.flat[len(errors.labels) :])
        draw_around_reversals(place := next(rest), errors)
        place.set(xlabel="time from the nearest reversal [s]", ylabel=f"error [{current}]")
        draw_time_spectrum(place := next(rest), errors.spectrum)
        small_title(place, "grey: noise of the current")
        place.set(xlabel="frequency [Hz]", ylabel=f"density of the error [{current}²/Hz]")
        draw_position_spectrum(place := next(rest), errors.over_position)
        place.set(xlabel=f"cycles per {unit}", ylabel=f"amplitude of the error [{current}]")
        draw_autocorrelation(place := next(rest), errors.autocorrelation)
        small_title(place, "grey: 95 % of what is there by chance")
        place.set(xlabel="lag [s]", ylabel="autocorrelation of the error")
        draw_shares(place := next(rest), errors.shares)
        place.set(xlabel="share of the squared error [%]")
        draw_recordings(place := next(rest), errors.by_recording)
        place.set(xlabel="error of the current [%]")
        draw_opposing(place := next(rest), errors.opposing)
        place.set(xlabel=f"error opposing the motion [{current}]")
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


def _draw_currents(axes: Axes, trace: MotorSeries) -> None:
    time = with_gaps(trace, trace.time)
    axes.plot(
        time,
        with_gaps(trace, trace.measured),
        color=ON_WHITE.measured,
        linewidth=3.2,
        alpha=0.45,
        label="measured",
    )
    axes.plot(
        time, with_gaps(trace, trace.modelled), color=ON_WHITE.modelled, linewidth=1.1, label="modelled"
    )
    axes.margins(x=0.01)


def _draw_error(axes: Axes, trace: MotorSeries) -> None:
    draw_noise_band(axes, trace.noise)
    axes.plot(
        with_gaps(trace, trace.time),
        with_gaps(trace, trace.error),
        color=ON_WHITE.error,
        linewidth=0.8,
        label="error",
    )
    axes.margins(x=0.01)


def with_gaps(trace: MotorSeries, values: np.ndarray) -> np.ndarray:
    """Values with NaN where rows are missing, so that no line is drawn across."""
    return np.asarray(np.insert(values, np.flatnonzero(np.diff(trace.row) > 1) + 1, np.nan))
