"""Figures of a trial on a page: what was named for what, misses by size, intervals, remaining errors."""

from collections.abc import Sequence

from bench.page.chart_spec import chart_figure
from bench.page.parts import Figure
from bench.studies.sweep.journal import Row
from bench.studies.trial.charts import confusion_chart, coverage_chart, errors_chart, misses_chart
from bench.studies.trial.summary import TrialSummary

CELL, LABELS = 25, 190  # px


def confusion_figure(summary: TrialSummary) -> Figure:
    """Hidden effect down, first named across."""
    chart = confusion_chart(summary)
    rows, columns = chart.y.categories, chart.x.categories
    height = 70 + 7 * max(map(len, columns)) + CELL * len(rows)
    return chart_figure(chart, height, least=LABELS + CELL * len(columns), turned=True)


def misses_figure(summary: TrialSummary) -> Figure:
    """Share of effects that are not named first, by size."""
    return chart_figure(misses_chart(summary), 270)


def coverage_figure(summary: TrialSummary) -> Figure:
    """Share of the 95 % intervals that hold the truth, for each parameter."""
    return chart_figure(coverage_chart(summary), 76 + 22 * len(summary.coverage))


def errors_figure(rows: Sequence[Row]) -> Figure | None:
    """Error over the noise floor before and after; None without any hidden effect."""
    chart = errors_chart(rows)
    return None if chart is None else chart_figure(chart, 320, name="Error before and after")
