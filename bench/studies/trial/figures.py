"""Pictures of a trial: its charts as files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from bench.basics.figure_style import STYLE
from bench.basics.files.atomic import atomic_path
from bench.document.charts.chart import Chart
from bench.document.figures.draw import draw
from bench.studies.sweep.journal import Row
from bench.studies.trial.charts import confusion_chart, errors_chart, misses_chart
from bench.studies.trial.summary import NOTHING, TrialSummary

CELL = 0.26  # inches


def write_figures(summary: TrialSummary, rows: Sequence[Row], stem: Path) -> list[Path]:
    """Draw what there are cases for: STEM_confusion.png, STEM_misses.png, STEM_errors.png."""
    drawn = []
    charts: Mapping[str, tuple[Chart | None, Callable[[Chart, str], Figure]]] = {
        "confusion": (confusion_chart(summary) if set(summary.confusion) - {NOTHING} else None, _matrix),
        "misses": (misses_chart(summary) if any(miss.first.of for miss in summary.misses) else None, _plain),
        "errors": (errors_chart(rows), _plain),
    }
    for name, (chart, figure_of) in charts.items():
        if chart is None:
            continue
        path = stem.with_name(f"{stem.name}_{name}.png")
        with mpl.rc_context(STYLE):
            figure = figure_of(chart, summary.robot)
            with atomic_path(path) as partial:
                figure.savefig(partial, dpi=130)
        drawn.append(path)
    return drawn


def _matrix(chart: Chart, robot: str) -> Figure:
    size = (3.2 + CELL * len(chart.x.categories), 2.6 + CELL * len(chart.y.categories))
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.add_subplot()
    draw(axes, chart)
    axes.tick_params(labelsize=7)
    axes.xaxis.label.set_fontsize(8)
    axes.yaxis.label.set_fontsize(8)
    axes.tick_params(axis="x", rotation=90)
    figure.suptitle(f"{robot}: {chart.title}", fontsize=8, x=0.01, ha="left")
    return figure


def _plain(chart: Chart, robot: str) -> Figure:
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    draw(axes, chart, letters=14)
    axes.legend(frameon=False, fontsize=8)
    axes.set_title(f"{robot}: {chart.title}", fontsize=9, loc="left")
    return figure
