"""Charts of a model: currents of one motor with their errors, the ladder, and the drive gains."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.diagnosis.result import Diagnosis
from bench.document.charts.chart import Axis, Band, Chart, Levels, Line, Panel, Role, Rule, Spans
from bench.document.charts.motor import NOISE_BAND
from bench.document.diagnosis import step_labels
from bench.document.numbers import error_where_moving, gain_change, percent, pretty_unit
from bench.identification.result import CurrentSeries, DriveGain
from bench.residuals.motor import MotorSeries

TIME = "time from the start of the recording"
Curve = tuple[Role, str, MotorSeries]
"""Role, name and series of one error curve."""


def currents_chart(curves: Sequence[Curve], unit: str, title: str) -> Chart:
    """Currents above, errors below. curves: the errors to show; the current drawn is that of the last.

    With several models, a further panel shows the error of the last one at its scale.
    """
    *_, (role, name, last) = curves
    time, measured, modelled = (_with_gaps(last, v) for v in (last.time, last.measured, last.modelled))
    noise = Band(NOISE_BAND, "noise", -last.noise, last.noise)
    panels = [
        _currents(time, measured, modelled, unit),
        Panel(Axis("error", unit), (noise, *map(_error_line, curves))),
    ]
    if len(curves) > 1:
        axis = Axis(f"error {name}, enlarged", unit)
        panels.append(Panel(axis, (noise, _error_line((role, name, last)))))
    return Chart(title, Axis(TIME, "s"), tuple(panels))


def fitted_currents_chart(series: CurrentSeries, motor: int, spread: float, unit: str, title: str) -> Chart:
    """Currents and error of one motor in one recording, in all rows. spread: standard deviation of the fitted errors.

    The error and its band are in thousandths of the unit.
    """
    time = series.time - series.time[0]
    band = Band("± one standard deviation of the fitted errors", "error", -1e3 * spread, 1e3 * spread)
    currents = _currents(time, series.measured[:, motor], series.modelled[:, motor], unit)
    error = Line("error", "error", time, 1e3 * error_where_moving(series)[:, motor])
    return Chart(title, Axis(TIME, "s"), (currents, Panel(Axis("error", f"m{unit}"), (band, error))))


def _currents(time: np.ndarray, measured: np.ndarray, modelled: np.ndarray, unit: str) -> Panel:
    lines = (Line("measured", "measured", time, measured), Line("modelled", "modelled", time, modelled))
    return Panel(Axis("current", unit), lines, 1.5)


def before_after_chart(
    before: CurrentSeries | None, after: CurrentSeries, motor: int, unit: str, title: str
) -> Chart:
    """Errors of one motor by the models without and with the missing effects, or of one model if nothing is missing."""
    models: list[tuple[str, Role, CurrentSeries]]
    models = [("the model as it is: nothing is missing", "after", after)]
    if before is not None:
        models = [("the model as it is", "before", before), ("with the missing effects", "after", after)]
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
    """Values with NaN for missing rows, so that no line is drawn across the gap."""
    return np.asarray(np.insert(values, np.flatnonzero(np.diff(series.row) > 1) + 1, np.nan))


def ladder_chart(diagnosis: Diagnosis) -> Chart:
    """Error of the current, fitted and not fitted, after each added effect, and the noise of the currents."""
    steps, floor = diagnosis.ladder, diagnosis.unexplained.noise_floor
    both: tuple[tuple[Role, str, list[float | None]], ...] = (
        ("before", "fitted", [step.identify for step in steps]),
        ("after", "not fitted", [step.validate for step in steps]),
    )
    levels = tuple(
        Levels(
            name,
            role,
            np.array([np.nan if value is None else value for value in values]),
            tuple("" if value is None else percent(value) for value in values),
        )
        for role, name, values in both
        if any(value is not None for value in values)
    )
    noise = Rule(f"noise of the currents, {percent(floor)}", "noise", "y", floor)
    return Chart(
        "Error after each added effect",
        Axis("", scale="band", categories=tuple(step_labels([step.effects for step in steps]))),
        (Panel(Axis("error of the current", "%", "log", room=True), (noise, *levels)),),
        aid="At the grey line only noise remains. If only the fitted error falls, the model fits noise.",
    )


def gains_chart(models: Sequence[tuple[Role, str, Mapping[str, DriveGain]]]) -> Chart:
    """Drive gains with their 95 % intervals against their nominal values; models: role, name, gains by joint."""
    series = []
    for i, (role, name, gains) in enumerate(models):
        known = [gain if gain.determined else None for gain in gains.values()]
        value = np.array([np.nan if gain is None else gain_change(gain) for gain in known])
        half = WITHIN_95 * np.array(
            [np.nan if gain is None else gain.std / abs(gain.nominal) for gain in known]
        )
        shift = 0.0 if len(models) == 1 else 0.3 * (i - 0.5)
        at = np.arange(len(gains))
        series.append(Spans(name, role, at, value, value - half, value + half, shift))
    names = tuple(f"{joint} [{pretty_unit(gain.unit)}]" for joint, gain in models[-1][2].items())
    rule = Rule("nominal value", "noise", "x", 0.0)
    return Chart(
        "Drive gains against their nominal values",
        Axis("difference to the nominal gain", "%", room=True),
        (Panel(Axis("", scale="band", categories=names), (rule, *series)),),
        aid="Whiskers: 95 % intervals, where they are wider than a dot. A maker's sheet is often wrong by a tenth.",
    )
