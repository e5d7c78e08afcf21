"""Charts of a trial: confusion matrix, misses by size, intervals, remaining errors."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from bench.basics.chi_squared import CONFIDENCE
from bench.basics.figure_style import STYLE
from bench.document.charts.chart import Axis, Cells, Chart, Panel, Points, Role, Rule, Series, Spans, Whiskers
from bench.document.figures.draw import draw
from bench.document.figures.write import CHART_DPI, chart_figure, write_figures
from bench.document.typeset import effect_name
from bench.studies.sweep.journal import Row
from bench.studies.trial.markdown import size_text
from bench.studies.trial.summary import A_LAW, LARGE, NOTHING, SOMETHING, TrialSummary
from bench.studies.trial.target import FLOOR_FACTOR, Share, ends_of

CELL, SIZE = 0.26, (6.4, 3.8)  # inches
LETTERS = 14  # characters of a class per line


def confusion_chart(summary: TrialSummary) -> Chart:
    """Rows: hidden effects; columns: first named effects. The shade is the share of a row's cases."""
    hidden = [name for name in summary.confusion if name != NOTHING]
    hidden += [NOTHING] * (NOTHING in summary.confusion)
    named = {name for line in summary.confusion.values() for name in line}
    across = [name for name in hidden if name in named and name != NOTHING]
    across += sorted(named - set(across) - {A_LAW, SOMETHING, NOTHING})
    across += [name for name in (A_LAW, SOMETHING, NOTHING) if name in named]
    cells = [
        (across.index(other), i, count / sum(summary.confusion[name].values()), str(count))
        for i, name in enumerate(hidden)
        for other, count in summary.confusion[name].items()
    ]
    x, y, shade, texts = zip(*cells, strict=True)
    rows = tuple(f"{effect_name(name)} ({sum(summary.confusion[name].values())})" for name in hidden)
    columns = tuple(effect_name(name) for name in across)
    return Chart(
        "Confusion matrix",
        Axis("named first", scale="band", categories=columns),
        (
            Panel(
                Axis("hidden (cases)", scale="band", categories=rows),
                (Cells("", "after", np.array(x), np.array(y), np.array(shade), texts),),
            ),
        ),
        aid="A number: cases. On the diagonal the hidden effect was named first. Only effects count whose error is "
        f"at least {LARGE:g} × the noise floor, and cases with nothing hidden.",
    )


def misses_chart(summary: TrialSummary) -> Chart:
    """Share of effects not named first, by their error over the noise floor."""
    classes = [miss for miss in summary.misses if miss.first.of]
    series = (
        _missed("not named first", "before", -0.1, [miss.first for miss in classes]),
        _missed("nor openly undecided", "after", 0.1, [miss.first_undecided for miss in classes]),
    )
    names = tuple(f"{size_text(miss)} ({miss.first.of})" for miss in classes)
    return Chart(
        "Effects missed, by size",
        Axis("error of the effect over the noise floor (cases)", scale="band", categories=names),
        (Panel(Axis("share of cases", "%", domain=(-0.04, 1.04)), series),),
        aid="Error of the effect: that of a model without it. Whiskers: 95 % intervals of the share.",
    )


def coverage_chart(summary: TrialSummary) -> Chart:
    """Share of the 95 % intervals that contain the truth, for each parameter."""
    ends = ends_of(covered.within for covered in summary.coverage)
    shares = Spans("share, with its 95 % interval", "after", np.arange(len(summary.coverage)), *ends)
    rule = Rule("95 %", "noise", "x", CONFIDENCE, dashed=True)
    names = tuple(
        f"{effect_name(covered.effect)} {covered.parameter} ({covered.within.of})"
        for covered in summary.coverage
    )
    return Chart(
        "Share of the intervals that hold the truth",
        Axis("intervals that hold the truth", "%", domain=(-0.02, 1.02)),
        (Panel(Axis("", scale="band", categories=names), (rule, shares)),),
        aid="In brackets: how many intervals. A whisker that misses the line: this parameter's standard errors are "
        "off.",
    )


def errors_chart(rows: Sequence[Row]) -> Chart | None:
    """Error over the noise floor before and after the diagnosis, a dot for each case; None without such cases."""
    done = [
        row
        for row in rows
        if row["status"] == "ok" and row["kind"] not in ("nothing", "outside") and not row["absorbed"]
    ]
    if not done:
        return None
    series: list[Series] = [Rule(f"{FLOOR_FACTOR:g}", "noise", "y", FLOOR_FACTOR, dashed=True)]
    sets: tuple[tuple[bool, Role, str], ...] = (
        (True, "after", "set exact"),
        (False, "before", "set not exact"),
    )
    for exact, role, name in sets:
        chosen = [row for row in done if bool(row["exact"]) is exact]
        if chosen:
            before, after = (
                np.array([row[f"error_over_floor.{when}"] for row in chosen]) for when in ("before", "after")
            )
            series.append(Points(f"{name} ({len(chosen)})", role, before, after))
    return Chart(
        "Error before and after, over the noise floor",
        Axis("error before, over the noise floor", scale="log", room=True),
        (Panel(Axis("error after, over the noise floor", scale="log"), tuple(series)),),
        aid="A dot: a case. Below the dashed line only noise remains, within the limit of the trial.",
    )


def _missed(name: str, role: Role, shift: float, shares: Sequence[Share]) -> Whiskers:
    share, high, low = 1.0 - ends_of(shares)
    return Whiskers(name, role, np.arange(len(shares)) + shift, share, low, high, joined=False)


def write_trial_figures(summary: TrialSummary, rows: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the figures that have cases: ROBOT_confusion.png, ROBOT_misses.png, ROBOT_errors.png."""
    figures = {}
    if set(summary.confusion) - {NOTHING}:
        figures["confusion"] = _matrix(confusion_chart(summary), summary.robot)
    plain = {
        "misses": misses_chart(summary) if any(miss.first.of for miss in summary.misses) else None,
        "errors": errors_chart(rows),
    }
    for name, chart in plain.items():
        if chart is not None:
            title = f"{summary.robot}: {chart.title}"
            figures[name] = chart_figure(chart, title, SIZE, letters=LETTERS)
    named = {f"{summary.robot}_{name}.png": figure for name, figure in figures.items()}
    return write_figures(folder, named, dpi=CHART_DPI)


def _matrix(chart: Chart, robot: str) -> Figure:
    size = (3.2 + CELL * len(chart.x.categories), 2.6 + CELL * len(chart.y.categories))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.add_subplot()
        draw(axes, chart)
        axes.tick_params(labelsize=7)
        axes.xaxis.label.set_fontsize(8)
        axes.yaxis.label.set_fontsize(8)
        axes.tick_params(axis="x", rotation=90)
        figure.suptitle(f"{robot}: {chart.title}", fontsize=8, x=0.01, ha="left")
    return figure
