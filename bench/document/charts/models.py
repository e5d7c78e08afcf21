"""Charts of models: the error after each added effect, and drive gains against their nominal values."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.diagnosis.result import Diagnosis
from bench.document.charts.chart import Axis, Chart, Levels, Panel, Role, Rule, Spans
from bench.document.diagnosis import step_labels
from bench.document.numbers import gain_change, percent, pretty_unit
from bench.identification.result import DriveGain


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
        known = [
            (gain_change(gain), gain.std / abs(gain.nominal)) for gain in gains.values() if gain.determined
        ]
        value, half = np.full(len(gains), np.nan), np.full(len(gains), np.nan)
        there = [gain.determined for gain in gains.values()]
        value[there], half[there] = [change for change, _ in known], [WITHIN_95 * std for _, std in known]
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
