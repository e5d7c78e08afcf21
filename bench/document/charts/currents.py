"""Measured and modelled current of one motor over time, with the errors below, as a chart."""

from collections.abc import Sequence

import numpy as np

from bench.document.charts.chart import Axis, Band, Chart, Line, Panel, Role
from bench.document.charts.motor import NOISE_BAND
from bench.document.numbers import error_where_moving
from bench.identification.result import CurrentSeries
from bench.residuals.motor import MotorSeries

TIME = "time from the start of the recording"
Curve = tuple[Role, str, MotorSeries]
"""Role, name and series of one error curve."""


def currents_chart(curves: Sequence[Curve], unit: str, title: str) -> Chart:
    """Currents above, errors below. curves: the errors to show, that of the model whose current is drawn last.

    With several models the last one's error appears once more in a separate panel, at its scale.
    """
    *_, (role, name, last) = curves
    time = _with_gaps(last, last.time)
    currents = (
        Line("measured", "measured", time, _with_gaps(last, last.measured)),
        Line("modelled", "modelled", time, _with_gaps(last, last.modelled)),
    )
    noise = Band(NOISE_BAND, "noise", -last.noise, last.noise)
    panels = [
        Panel(Axis("current", unit), currents, 1.5),
        Panel(Axis("error", unit), (noise, *map(_error_line, curves))),
    ]
    if len(curves) > 1:
        axis = Axis(f"error {name}, enlarged", unit)
        panels.append(Panel(axis, (noise, _error_line((role, name, last)))))
    return Chart(title, Axis(TIME, "s"), tuple(panels))


def fitted_currents_chart(series: CurrentSeries, motor: int, spread: float, unit: str, title: str) -> Chart:
    """Currents and error of one motor in one recording, all rows. spread: standard deviation of the fitted errors.

    The error and its band are in thousandths of the unit.
    """
    time = series.time - series.time[0]
    band = Band("± one standard deviation of the fitted errors", "error", -1e3 * spread, 1e3 * spread)
    currents = (
        Line("measured", "measured", time, series.measured[:, motor]),
        Line("modelled", "modelled", time, series.modelled[:, motor]),
    )
    error = Line("error", "error", time, 1e3 * error_where_moving(series)[:, motor])
    panels = (Panel(Axis("current", unit), currents, 1.5), Panel(Axis("error", f"m{unit}"), (band, error)))
    return Chart(title, Axis(TIME, "s"), panels)


def before_after_chart(
    before: CurrentSeries | None, after: CurrentSeries, motor: int, unit: str, title: str
) -> Chart:
    """Errors of one motor by the models without and with what is missing, or of one model where nothing is."""
    named = "the model as it is: nothing is missing" if before is None else "with the missing effects"
    models: list[tuple[str, Role, CurrentSeries]] = [(named, "after", after)]
    if before is not None:
        models.insert(0, ("the model as it is", "before", before))
    lines = tuple(
        Line(name, role, model.time - model.time[0], error_where_moving(model)[:, motor])
        for name, role, model in models
    )
    return Chart(title, Axis(TIME, "s"), (Panel(Axis("error", unit), lines),))


def _error_line(curve: Curve) -> Line:
    role, name, series = curve
    time = _with_gaps(series, series.time)
    return Line(f"error {name}".strip(), role, time, _with_gaps(series, series.error))


def _with_gaps(series: MotorSeries, values: np.ndarray) -> np.ndarray:
    """Values with NaN where rows are missing, so that no line is drawn across."""
    return np.asarray(np.insert(values, np.flatnonzero(np.diff(series.row) > 1) + 1, np.nan))
