"""Figures of a sweep on a page: a metric against an axis, and how metrics spread over all runs."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from bench.document.charts.chart import Chart, Whiskers
from bench.page.chart_spec import chart_figure, spec_of
from bench.page.parts import Figure, PageChart, Variant
from bench.studies.sweep.charts import ROLES, plot_chart, spread_chart

MOST_LETTERS = 70  # of names side by side below an axis
HIGH, LOW, SPREAD = 300, 200, 210  # px


def plot_figure(table: Path, x: str, y: str, lines: str | None, picked: Collection[str] = ()) -> Figure:
    """A metric against an axis; more lines than colours stand side by side, each in a separate chart."""
    chart = plot_chart(table, x, y, lines, picked)
    names = chart.x.categories
    turned = sum(map(len, names)) > MOST_LETTERS
    room = 6 * max(map(len, names)) if turned else 0
    drawn = [series for series in chart.series if isinstance(series, Whiskers)]
    if len(drawn) <= len(ROLES):
        return chart_figure(chart, HIGH + room, turned=turned)
    charts = tuple(
        PageChart(alone.name, "", spec_of(_only(chart, alone), LOW + room, turned=turned)) for alone in drawn
    )
    return Figure(chart.title, chart.aid, False, (), {"": Variant(charts)}, ("",))


def _only(chart: Chart, kept: Whiskers) -> Chart:
    """A chart with one of its lines, which needs no name there."""
    (panel,) = chart.panels
    rest = tuple(series for series in panel.series if not isinstance(series, Whiskers))
    series = (*rest, replace(kept, name="", role=ROLES[0]))
    return replace(chart, panels=(replace(panel, series=series),))


def spread_figure(columns: Mapping[str, Sequence[Any]], metrics: Sequence[str]) -> Figure:
    """A histogram of each metric over all runs."""
    charts = [spread_chart(metric, columns[metric]) for metric in metrics]
    shown = tuple(PageChart(chart.title, "", spec_of(chart, SPREAD)) for chart in charts)
    aid = "How many runs fall where; none is left out."
    return Figure("Histograms", aid, False, (), {"": Variant(shown)}, ("",))
