"""A diagnosis as pictures: the ladder, the errors before and after, the gains, and what is left."""

from itertools import pairwise
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from bench.compare.motor import compared
from bench.dataset import Dataset
from bench.diagnose.result import Diagnosis
from bench.diagnose.split import with_judged_parts
from bench.diagnose.summary import and_list, said
from bench.estimate.result import CurrentSeries, Quantity, relative_error
from bench.files import atomic_path
from bench.show.comparison_figures import errors_figure
from bench.show.figures import COLUMN_WIDTH, DPI, LEAST_WIDTH, MOTOR_HEIGHT, STYLE
from bench.show.numbers import current_unit, is_poor, judged_error, percent, pretty_unit

BEFORE, AFTER, NOISE = "#D55E00", "#0072B2", "#9AA0A6"  # after Okabe and Ito
INTERVAL = 1.96  # deviations: 95 %
PLAIN = FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−"))


def write_diagnosis_figures(folder: Path, diagnosis: Diagnosis, dataset: Dataset) -> list[Path]:
    """Write ladder.png, errors.png, gains.png and, for what is left, left_MOTOR.png, and tell their paths.

    dataset: the one that was diagnosed.
    """
    judged, _ = with_judged_parts(dataset)
    left = compared(dataset.robot, judged.recordings, diagnosis.after.recordings, diagnosis.after.settings)
    pages = {"ladder.png": ladder_figure(diagnosis), "errors.png": errors_before_after_figure(diagnosis)}
    if diagnosis.missing:
        pages["gains.png"] = gains_figure(diagnosis)
    pages |= {f"left_{joint}.png": errors_figure(left, joint) for joint in left.joints if left.of(joint)}
    for name, figure in pages.items():
        with atomic_path(folder / name) as partial:
            figure.savefig(partial)
    return [folder / name for name in pages]


def ladder_figure(diagnosis: Diagnosis) -> Figure:
    """Error of the current, fitted and not fitted, after each added effect, and the noise of the currents."""
    steps = diagnosis.ladder
    names = ["the model\nas it is"]
    names += [
        "+ " + "\n".join(said(name) for name in after.effects if name not in before.effects)
        for before, after in pairwise(steps)
    ]
    at = np.arange(len(steps))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(max(1.9 * len(steps) + 1.8, 5.6), 4.0), dpi=DPI, layout="constrained")
        axes = figure.subplots()
        floor = 100.0 * diagnosis.unexplained.noise_floor
        axes.axhline(floor, color=NOISE, linewidth=3.0, alpha=0.7, label="noise of the currents")
        for values, colour, marker, label in (
            ([one.identify for one in steps], BEFORE, "s", "fitted"),
            ([one.validate for one in steps], AFTER, "o", "not fitted"),
        ):
            known = [(i, 100.0 * value) for i, value in zip(at, values, strict=True) if value is not None]
            axes.plot(
                [i for i, _ in known],
                [value for _, value in known],
                color=colour,
                marker=marker,
                markersize=6.0,
                linewidth=1.4,
                label=label,
                fillstyle="none" if marker == "s" else "full",
            )
        for i, one in zip(at, steps, strict=True):
            value = one.validate if one.validate is not None else one.identify
            if value:
                axes.annotate(
                    percent(value),
                    (i, 100.0 * value),
                    (7, 7),
                    textcoords="offset points",
                    fontsize=8.5,
                    color="#3A424C",
                )
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(PLAIN)
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.set_xticks(at, names)
        axes.set_xlim(-0.5, len(steps) - 0.3)
        axes.set_ylabel("error of the current [%]")
        axes.set_title(f"{diagnosis.robot}: error after each added effect")
        axes.legend(frameon=False)
    return figure


def errors_before_after_figure(diagnosis: Diagnosis) -> Figure:
    """Error of every motor on recordings that were not fitted, by the models without and with what is missing."""
    chosen = [one for one in diagnosis.before.recordings if one.use == "validate"]
    chosen = chosen or list(diagnosis.before.recordings)
    after = {one.name: one for one in diagnosis.after.recordings}
    gains = diagnosis.after.drive_gains
    with mpl.rc_context(STYLE):
        size = (max(COLUMN_WIDTH * len(chosen), LEAST_WIDTH), 0.8 * MOTOR_HEIGHT * len(gains) + 0.9)
        figure = Figure(figsize=size, dpi=DPI, layout="constrained")
        axes = figure.subplots(len(gains), len(chosen), sharex="col", sharey="row", squeeze=False)
        for column, one in enumerate(chosen):
            for j, (joint, gain) in enumerate(gains.items()):
                _draw_before_after(axes[j, column], one, after[one.name], j)
                if column == 0:
                    axes[j, 0].set_ylabel(f"error of {joint} [{current_unit(gain.unit)}]")
            errors = [percent(relative_error([series])) for series in (one, after[one.name])]
            axes[0, column].set_title(f"{one.name}: error {errors[0]}, then {errors[1]}")
            axes[-1, column].set_xlabel("time [s]")
            axes[-1, column].xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        figure.legend(handles=axes[0, 0].get_lines(), loc="outside upper center", ncols=2, frameon=False)
    return figure


def gains_figure(diagnosis: Diagnosis) -> Figure:
    """Drive gains and parameters before and after with their 95 % intervals, in percent of the value after.

    Gains that were not fitted are left out, and parameters that the data hardly determine.
    """
    before = {one.name: one for one in diagnosis.before.parameters}
    rows: list[tuple[str, Quantity, Quantity]] = [
        (f"gain {joint} [{pretty_unit(gain.unit)}]", diagnosis.before.drive_gains[joint], gain)
        for joint, gain in diagnosis.after.drive_gains.items()
        if diagnosis.after.gains_fitted
    ]
    rows += [
        (f"{one.name} [{pretty_unit(one.unit)}]", before[one.name], one)
        for one in diagnosis.after.parameters
        if one.name in before and not is_poor(one)
    ]
    at = np.arange(len(rows))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 0.3 * len(rows) + 1.6), dpi=DPI, layout="constrained")
        axes = figure.subplots()
        scale = [100.0 / abs(after.value) for *_, after in rows]
        for shift, colour, marker, label, values in (
            (-0.16, BEFORE, "s", "before", [one for _, one, _ in rows]),
            (0.16, AFTER, "o", "after", [one for *_, one in rows]),
        ):
            axes.errorbar(
                [(one.value - row[2].value) * s for one, row, s in zip(values, rows, scale, strict=True)],
                at + shift,
                xerr=[INTERVAL * one.std * s for one, s in zip(values, scale, strict=True)],
                fmt=marker,
                color=colour,
                markersize=4.0,
                capsize=2.0,
                linewidth=1.2,
                label=label,
            )
        axes.axvline(0.0, color="#8A929C", linewidth=0.8)
        axes.set_xscale("symlog", linthresh=1.0)
        axes.xaxis.set_major_formatter(PLAIN)
        axes.set_yticks(at, [name for name, *_ in rows])
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.set_xlabel("difference to the value after, with 95 % intervals [%]; beyond ±1 % logarithmic")
        added = and_list([said(one) for one in diagnosis.missing])
        axes.set_title(f"{diagnosis.robot}: what moves with {added}")
        figure.legend(loc="outside upper right", ncols=2, frameon=False)
    return figure


def _draw_before_after(axes: Axes, before: CurrentSeries, after: CurrentSeries, motor: int) -> None:
    for series, colour, label in (
        (before, BEFORE, "the model as it is"),
        (after, AFTER, "with what is missing"),
    ):
        time = series.time - series.time[0]
        axes.plot(time, judged_error(series)[:, motor], color=colour, linewidth=0.9, label=label)
    axes.margins(x=0.01)
