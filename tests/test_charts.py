"""Charts are values, made once: both renderers know every kind of series and draw the same numbers."""

import ast
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from bench.document.charts import chart as charts
from bench.document.charts.chart import Axis, Binned, Chart, Line, Panel
from bench.document.charts.currents import currents_chart
from bench.document.charts.motor import motor_charts
from bench.document.figures.draw import draw
from bench.page.chart_spec import page_chart, rows_a_pair, spec_of
from bench.residuals.error_breakdown import error_breakdown
from tests.compared_kit import made, white

FIVE = np.arange(5.0)
ENDS = (FIVE + 0.5, FIVE, FIVE + 1.0)
SAMPLES = {
    charts.Line: lambda kind: kind("a", "error", FIVE, FIVE, markers=True),
    charts.Levels: lambda kind: kind("a", "after", FIVE + 1.0, ("1", "2", "3", "4", "5")),
    charts.Band: lambda kind: kind("a", "noise", -1.0, 1.0),
    charts.Rule: lambda kind: kind("a", "noise", "y", 0.5, dashed=True),
    charts.Binned: lambda kind: kind("a", "forwards", FIVE, FIVE, np.arange(6.0), *ENDS, FIVE, FIVE, FIVE),
    charts.Whiskers: lambda kind: kind("a", "one", FIVE, *ENDS, pick=({"x": "1"},) * 5),
    charts.Spans: lambda kind: kind("a", "after", FIVE, *ENDS, 0.1),
    charts.Bars: lambda kind: kind("a", "error", FIVE, thin=True),
    charts.Points: lambda kind: kind("a", "after", FIVE, FIVE),
    charts.Stems: lambda kind: kind("a", "error", FIVE, FIVE),
    charts.Histogram: lambda kind: kind("a", "error", np.arange(6.0), FIVE),
    charts.Cells: lambda kind: kind("", "after", np.arange(5), np.arange(5), FIVE / 4.0, ("a",) * 5),
}


@pytest.fixture(scope="module")
def what():
    return made(lambda row, random: 0.1 * np.sign(row["velocity"]) + white(random), joints=("left",))


@pytest.mark.parametrize("kind", charts.Series.__subclasses__())
def test_both_renderers_draw_every_kind_of_series(kind):
    series = SAMPLES[kind](kind)
    names = Axis("names", scale="band", categories=tuple("abcde"))
    banded = kind in (charts.Levels, charts.Cells)
    chart = Chart("t", names if banded else Axis("x", "s"), (Panel(Axis("y", "A"), (series,)),))
    (drawn,) = spec_of(chart, 200)["panels"][0]["series"]
    assert drawn["role"] == series.role
    assert drawn["name"] == series.name
    axes = Figure().subplots()
    draw(axes, chart)
    assert axes.has_data()


def test_a_page_and_a_picture_show_the_same_numbers(what):
    drawn_by_page = {}
    for name, chart in motor_charts(error_breakdown(what, "left")).items():
        drawn_by_page[name] = page_chart(chart).spec
        axes = Figure().subplots()
        draw(axes, chart)
        assert drawn_by_page[name]["label"] == chart.title
        lines = {line.get_label(): np.asarray(line.get_ydata()) for line in axes.get_lines()}
        for series, spec in zip(chart.series, drawn_by_page[name]["panels"][0]["series"], strict=True):
            if isinstance(series, Binned):
                extent = np.ptp(series.high)
                np.testing.assert_allclose(spec["mean"], lines[series.name], atol=1e-3 * extent)
    assert set(drawn_by_page) >= {"velocity", "spectrum", "autocorrelation", "histogram"}


def test_a_long_curve_keeps_its_extremes_and_its_gaps(what):
    (series, *_) = what.of("left")
    chart = currents_chart([("error", "", series)], "A", "left")
    most = 60
    error = spec_of(chart, 200, most=most)["panels"][1]["series"][1]
    values = np.array([np.nan if value is None else value for value in error["y"]])
    assert len(values) <= most + 2
    assert rows_a_pair(chart, most) > 1
    assert np.nanmax(values) == pytest.approx(series.error.max(), abs=1e-3)
    gap = np.where((FIVE > 1) & (FIVE < 3), np.nan, FIVE)
    whole = Chart("t", Axis("x"), (Panel(Axis("y"), (Line("a", "error", gap, gap),)),))
    (line,) = spec_of(whole, 200, most=100)["panels"][0]["series"]
    assert line["y"] == [0, 1, None, 3, 4]


def test_no_page_makes_a_series_of_its_own():
    """What is drawn is a `Chart`; the script's own form is written in one file."""
    kinds = {"line", "band", "bins", "points", "stems", "histogram", "hbars", "intervals", "cells", "rule"}
    for path in Path("bench").rglob("*.py"):
        if path.name == "chart_spec.py":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            for key, value in zip(node.keys, node.values, strict=True) if isinstance(node, ast.Dict) else ():
                named = isinstance(key, ast.Constant) and key.value == "kind"
                assert not (named and isinstance(value, ast.Constant) and value.value in kinds), path
