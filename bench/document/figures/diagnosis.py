"""A diagnosis as pictures: the ladder, the errors before and after, the gains, and the residual."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.basics.figure_style import DPI, STYLE
from bench.basics.files.atomic import atomic_path
from bench.basics.joint_units import drive_unit
from bench.diagnosis.result import Diagnosis
from bench.document.charts.currents import before_after_chart
from bench.document.charts.models import ladder_chart
from bench.document.figures.comparison import errors_figure
from bench.document.figures.diagnosis_panels import draw_moved, moved
from bench.document.figures.draw import draw
from bench.document.layout import SCREEN
from bench.document.numbers import effect_name, percent
from bench.identification.result import CurrentSeries, relative_error
from bench.identification.wording import and_list
from bench.residuals.motor import Compared


def write_diagnosis_figures(folder: Path, diagnosis: Diagnosis, residuals: Compared) -> list[Path]:
    """Write errors.png, ladder.png, gains.png and, for the residual, errors_MOTOR.png, and tell their paths.

    Where nothing is missing there is no ladder and there are no gains before and after. residuals: the errors of
    the model with what is missing.
    """
    pages = {"errors.png": errors_before_after_figure(diagnosis)}
    if diagnosis.added:
        pages = {"ladder.png": ladder_figure(diagnosis), **pages, "gains.png": gains_figure(diagnosis)}
    pages |= {
        f"errors_{joint}.png": errors_figure(residuals, joint)
        for joint in residuals.joints
        if residuals.of(joint)
    }
    for name, figure in pages.items():
        with atomic_path(folder / name) as partial:
            figure.savefig(partial)
    return [folder / name for name in pages]


def ladder_figure(diagnosis: Diagnosis) -> Figure:
    """Error of the current, fitted and not fitted, after each added effect, and the noise of the currents."""
    chart = ladder_chart(diagnosis)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 0.62 * len(diagnosis.ladder) + 1.5), dpi=DPI, layout="constrained")
        axes = figure.subplots()
        draw(axes, chart)
        axes.set_title(f"{diagnosis.robot}: error after each added effect")
        axes.legend(frameon=False, loc="lower right")
    return figure


def errors_before_after_figure(diagnosis: Diagnosis) -> Figure:
    """Error of every motor on recordings that were not fitted, by the models without and with what is missing."""
    chosen = [trace for trace in diagnosis.after.recordings if trace.use == "validate"]
    chosen = chosen or list(diagnosis.after.recordings)
    before = {trace.name: trace for trace in diagnosis.before.recordings} if diagnosis.added else {}
    gains = {joint: diagnosis.after.drive_gains[joint] for joint in diagnosis.after.joints}
    columns = min(SCREEN.recordings, len(chosen))
    rows = -(-len(chosen) // columns)
    with mpl.rc_context(STYLE):
        size = (SCREEN.width, rows * (SCREEN.motor * len(gains) + 0.6) + 0.5)
        figure = Figure(figsize=size, dpi=DPI, layout="constrained")
        axes = figure.subplots(rows * len(gains), columns, sharex="col", squeeze=False)
        for place, after in enumerate(chosen):
            row, column = divmod(place, columns)
            for j, (joint, gain) in enumerate(gains.items()):
                panel = axes[row * len(gains) + j, column]
                title = _said_errors(after.name, joint, before.get(after.name), after, j)
                chart = before_after_chart(before.get(after.name), after, j, drive_unit(gain.unit), title)
                draw(panel, chart)
                panel.set(title=chart.title, xlabel="", ylabel=chart.y.title if column == 0 else "")
            axes[(row + 1) * len(gains) - 1, column].set_xlabel("time [s]")
        for panel in axes.flat:
            panel.set_visible(bool(panel.get_lines()))
            panel.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        handles = axes[0, 0].get_lines()
        figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)
    return figure


def gains_figure(diagnosis: Diagnosis) -> Figure:
    """Drive gains and parameters before and after with their 95 % intervals, in percent of the value after.

    Gains that were not fitted are omitted, and parameters that the data hardly determine.
    """
    rows = moved(diagnosis, parameters=True)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 0.32 * len(rows) + 1.7), dpi=DPI, layout="constrained")
        axes = figure.subplots()
        draw_moved(axes, rows)
        added = and_list([effect_name(name) for name in diagnosis.added])
        figure.suptitle(f"{diagnosis.robot}: what moves with {added}", x=0.01, ha="left", fontsize=10.5)
        figure.legend(loc="outside lower right", ncols=3, frameon=False)
    return figure


def _said_errors(
    name: str, joint: str, before: CurrentSeries | None, after: CurrentSeries, motor: int
) -> str:
    errors = [percent(relative_error([trace], motor)) for trace in (before, after) if trace is not None]
    return f"{name}, {joint}: error {', then '.join(errors)}"
