"""Figures of a diagnosis: the ladder, the errors before and after, the gains, and the residual."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, SymmetricalLogLocator

from bench.basics.chi_squared import WITHIN_95
from bench.basics.figure_style import DPI, STYLE
from bench.basics.joint_units import drive_unit
from bench.basics.sentence import and_list
from bench.diagnosis.result import Diagnosis
from bench.document.charts.currents import before_after_chart, ladder_chart
from bench.document.figures.comparison import errors_figures
from bench.document.figures.draw import COLOURS, PLAIN, ZERO, draw
from bench.document.figures.write import write_figures
from bench.document.layout import SCREEN
from bench.document.numbers import is_poor, percent, pretty_unit
from bench.effects.display_names import spoken
from bench.identification.result import Quantity, relative_error
from bench.residuals.motor import Compared

VERDICT_COLOURS = {
    "missing": COLOURS["after"],
    "indistinguishable": "#E69F00",
    "resembles": "#F0E442",
    "not supported": "#B8BEC6",
    "absorbed": "#CC79A7",
}
EVEN_NATS, EVEN_PERCENT = 10.0, 10.0


@dataclass(frozen=True)
class Moved:
    """A gain or a parameter of the models before and after, and a gain's nominal value."""

    name: str
    before: Quantity
    after: Quantity
    nominal: float | None = None

    @property
    def label(self) -> str:
        """The name with the unit."""
        return f"{self.name} [{pretty_unit(self.after.unit)}]"


def moved(diagnosis: Diagnosis, *, parameters: bool) -> list[Moved]:
    """The gains if they were fitted and, with `parameters`, the parameters of both models that are not poor."""
    before = {parameter.name: parameter for parameter in diagnosis.before.parameters}
    gains = [
        Moved(f"gain {joint}", diagnosis.before.drive_gains[joint], gain, gain.nominal)
        for joint, gain in diagnosis.after.drive_gains.items()
        if diagnosis.after.gains_fitted
    ]
    if not parameters:
        return gains
    return gains + [
        Moved(parameter.name, before[parameter.name], parameter)
        for parameter in diagnosis.after.parameters
        if parameter.name in before and not is_poor(parameter)
    ]


def draw_ranking(axes: Axes, diagnosis: Diagnosis, most: int, scale: float = 1.0) -> None:
    """Draw the evidence for each of the first `most` effects as a point in the colour of its verdict.

    Not as bars, whose lengths would be meaningless on a scale that is linear up to `EVEN_NATS` and logarithmic beyond.
    """
    ranked = [each for each in diagnosis.ranking if each.verdict != "absorbed"][:most]
    at = np.arange(len(ranked))
    axes.axvline(0.0, color=ZERO, linewidth=0.8 * scale)
    evidence = np.array([each.evidence for each in ranked])
    for verdict, colour in VERDICT_COLOURS.items():
        of_it = np.array([each.verdict == verdict for each in ranked], dtype=bool)
        if of_it.any():
            axes.plot(evidence[of_it], at[of_it], "o", color=colour, markersize=6.0 * scale, label=verdict)
    declared = even_then_logarithmic(axes, evidence, EVEN_NATS, "nats")
    axes.set_yticks(at, [spoken(each.effect) for each in ranked])
    axes.set_ylim(len(ranked) - 0.4, -0.6)
    axes.set_xlabel(f"evidence [nats]{declared}")
    axes.grid(visible=True, axis="y", linewidth=0.5 * scale, alpha=0.5)


def even_then_logarithmic(axes: Axes, values: Iterable[float], even: float, unit: str) -> str:
    """Make the horizontal axis logarithmic beyond ±even if a value is far beyond; return an addition to its label."""
    if max(map(abs, values), default=0.0) <= SCREEN.logarithmic * even:
        return ""
    axes.set_xscale("symlog", linthresh=even, linscale=0.5)
    axes.xaxis.set_major_locator(SymmetricalLogLocator(base=10.0, linthresh=even))
    axes.xaxis.set_major_formatter(PLAIN)
    return f",\nlogarithmic beyond ±{even:g} {unit}"


def draw_moved(axes: Axes, rows: Sequence[Moved], scale: float = 1.0) -> None:
    """Draw values before and after, with 95 % intervals in percent of the value after, and nominal gains between."""
    at = np.arange(len(rows))
    offset = 0.17 if all(row.nominal is None for row in rows) else 0.28
    factor = [100.0 / abs(row.after.value) if row.after.value else 0.0 for row in rows]
    for shift, colour, marker, label, values in (
        (-offset, COLOURS["before"], "s", "before", [row.before for row in rows]),
        (offset, COLOURS["after"], "o", "after", [row.after for row in rows]),
    ):
        moves = [quantity.value - row.after.value for quantity, row in zip(values, rows, strict=True)]
        axes.errorbar(
            np.multiply(moves, factor),
            at + shift,
            xerr=WITHIN_95 * np.multiply([quantity.std for quantity in values], factor),
            fmt=marker,
            color=colour,
            markersize=4.5 * scale,
            capsize=2.5 * scale,
            linewidth=1.3 * scale,
            label=label,
        )
    nominal = {
        i: (row.nominal - row.after.value) * f
        for i, row, f in zip(at, rows, factor, strict=True)
        if row.nominal is not None
    }
    if nominal:
        axes.plot(
            list(nominal.values()),
            list(nominal),
            "D",
            color="#5A6470",
            fillstyle="none",
            markersize=5.0 * scale,
            markeredgewidth=scale,
            label="nominal",
        )
    axes.axvline(0.0, color=ZERO, linewidth=0.8 * scale)
    declared = even_then_logarithmic(axes, axes.get_xlim(), EVEN_PERCENT, "%")
    axes.set_yticks(at, [row.label for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel(f"difference to the value after [%]{declared}")


def write_diagnosis_figures(folder: Path, diagnosis: Diagnosis, residuals: Compared) -> list[Path]:
    """Write errors.png, ladder.png, gains.png and, for the residual, errors_MOTOR.png; return their paths.

    If no effect was added, ladder.png and gains.png are omitted. residuals: the errors of the completed model.
    """
    pages = {"errors.png": errors_before_after_figure(diagnosis)}
    if diagnosis.added:
        pages = {"ladder.png": ladder_figure(diagnosis), **pages, "gains.png": gains_figure(diagnosis)}
    return write_figures(folder, pages | errors_figures(residuals))


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
    """Error of every motor by the models before and after, on recordings not fitted, or on all if there are none."""
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
                models = [model for model in (before.get(after.name), after) if model is not None]
                errors = ", then ".join(percent(relative_error([model], j)) for model in models)
                title = f"{after.name}, {joint}: error {errors}"
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

    Gains that were not fitted are omitted, and poorly determined parameters.
    """
    rows = moved(diagnosis, parameters=True)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 0.32 * len(rows) + 1.7), dpi=DPI, layout="constrained")
        axes = figure.subplots()
        draw_moved(axes, rows)
        added = and_list([spoken(name) for name in diagnosis.added])
        figure.suptitle(f"{diagnosis.robot}: what moves with {added}", x=0.01, ha="left", fontsize=10.5)
        figure.legend(loc="outside lower right", ncols=3, frameon=False)
    return figure
