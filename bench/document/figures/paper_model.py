"""Figures for papers on a model: gains against nominal values, and the result of a diagnosis."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.basics.joint_units import drive_unit
from bench.diagnosis.result import Diagnosis
from bench.document.charts.chart import Levels
from bench.document.charts.currents import before_after_chart, gains_chart, ladder_chart
from bench.document.figures.diagnosis import Moved, draw_moved, draw_ranking, moved
from bench.document.figures.paper import TIME, Numbers, PaperFigure, PaperPanel, file_part, panel
from bench.document.layout import PAPER
from bench.document.numbers import error_where_moving
from bench.identification.result import CurrentSeries, Identification


def gain_figure(result: Identification) -> PaperFigure:
    """Drive gains with their 95 % intervals, as changes in percent of the nominal values."""
    gains = result.drive_gains
    numbers: Numbers = {
        "joint": list(gains),
        "unit": [gain.unit for gain in gains.values()],
        "nominal": [gain.nominal for gain in gains.values()],
        "value": [gain.value for gain in gains.values()],
        "standard deviation": [gain.std for gain in gains.values()],
        "change [%]": [100.0 * (gain.value / gain.nominal - 1.0) for gain in gains.values()],
        "95 % interval [± %]": [100.0 * WITHIN_95 * gain.std / abs(gain.nominal) for gain in gains.values()],
    }
    height = PAPER.foot + 6.0 * len(gains)
    chart = gains_chart([("after", "identified, 95 % interval", gains)])
    return PaperFigure("drive_gains", (panel(chart, height),), {"": numbers})


def diagnosis_figures(diagnosis: Diagnosis) -> list[PaperFigure]:
    """The ranking and, if an effect was added, ladder, gains, parameters and errors before and after."""
    ranking = _ranking(diagnosis)
    if not diagnosis.added:
        return [ranking]
    before = {trace.name: trace for trace in diagnosis.before.recordings}
    held_out = [trace for trace in diagnosis.after.recordings if trace.use == "validate"]
    rows = moved(diagnosis, parameters=True)
    gains = [row for row in rows if row.nominal is not None]
    figures = [_ladder(diagnosis), ranking]
    figures += [_moved("gains_before_after", gains)] if gains else []
    figures += [_moved("parameters_before_after", [row for row in rows if row.nominal is None])]
    return figures + [_before_after(diagnosis, before[trace.name], trace) for trace in held_out]


def _ladder(diagnosis: Diagnosis) -> PaperFigure:
    chart, floor = ladder_chart(diagnosis), 100.0 * diagnosis.unexplained.noise_floor
    names = chart.x.categories
    numbers: dict[str, list[float | str | None]] = {"model": list(names)}
    levels = {series.name: 100.0 * series.values for series in chart.series if isinstance(series, Levels)}
    for name in ("fitted", "not fitted"):
        values = levels.get(name, np.full(len(names), np.nan))
        numbers[f"error, {name} [%]"] = [value if np.isfinite(value) else None for value in values.tolist()]
    numbers["noise of the currents [%]"] = [floor] * len(names)
    height = PAPER.foot + 2.2 * PAPER.bar * len(names)
    return PaperFigure("ladder", (panel(chart, height),), {"": numbers})


def _ranking(diagnosis: Diagnosis) -> PaperFigure:
    ranking = diagnosis.ranking
    numbers: Numbers = {
        "effect": [verdict.effect for verdict in ranking],
        "verdict": [verdict.verdict for verdict in ranking],
        "evidence [nats]": [verdict.evidence for verdict in ranking],
        "error without [%]": [100.0 * verdict.error_before for verdict in ranking],
        "error with [%]": [100.0 * verdict.error_after for verdict in ranking],
        "at": [" ".join(verdict.actuators) for verdict in ranking],
        "alternatives": [" ".join(verdict.alternatives) for verdict in ranking],
    }
    rows = min(PAPER.ranking, sum(verdict.verdict != "absorbed" for verdict in ranking))
    drawn = partial(draw_ranking, diagnosis=diagnosis, most=PAPER.ranking, scale=PAPER.scale)
    return PaperFigure("ranking", (PaperPanel(drawn, PAPER.foot + PAPER.bar * rows),), {"": numbers})


def _moved(name: str, rows: Sequence[Moved]) -> PaperFigure:
    numbers: dict[str, list[float | str | None]] = {
        "name": [row.name for row in rows],
        "unit": [row.after.unit for row in rows],
        "before": [row.before.value for row in rows],
        "standard deviation before": [row.before.std for row in rows],
        "after": [row.after.value for row in rows],
        "standard deviation after": [row.after.std for row in rows],
    }
    nominal = any(row.nominal is not None for row in rows)
    if nominal:
        numbers["nominal"] = [row.nominal for row in rows]
    height = PAPER.foot + (PAPER.gain if nominal else PAPER.parameter) * len(rows)
    drawn = partial(draw_moved, rows=rows, scale=PAPER.scale)
    return PaperFigure(name, (PaperPanel(drawn, height),), {"": numbers})


def _before_after(diagnosis: Diagnosis, before: CurrentSeries, after: CurrentSeries) -> PaperFigure:
    gains = {joint: diagnosis.after.drive_gains[joint] for joint in diagnosis.after.joints}
    time = after.time - after.time[0]
    numbers: dict[str, list[float | str | None]] = {TIME: time.tolist()}
    panels = []
    for j, (joint, gain) in enumerate(gains.items()):
        unit = drive_unit(gain.unit)
        numbers[f"error of {joint} before [{unit}]"] = error_where_moving(before)[:, j].tolist()
        numbers[f"error of {joint} after [{unit}]"] = error_where_moving(after)[:, j].tolist()
        chart = before_after_chart(before, after, j, unit, after.name)
        below = TIME if j == len(gains) - 1 else ""
        panels.append(panel(chart, PAPER.errors, ylabel=f"{joint} [{unit}]", xlabel=below))
    name = f"errors_before_after_{file_part(after.name)}"
    return PaperFigure(name, tuple(panels), {"": numbers}, stacked=True)
