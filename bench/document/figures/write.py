"""Figures as files, each written whole or not at all."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from bench.basics.figure_style import STYLE
from bench.basics.files.atomic import atomic_path
from bench.document.charts.chart import Chart
from bench.document.figures.draw import draw

CHART_DPI = 130


def write_figure(path: str | Path, figure: Figure, **options: Any) -> Path:
    """Write a figure in the format of the suffix and return the path. options: of matplotlib's `savefig`."""
    with mpl.rc_context(STYLE), atomic_path(path) as partial:
        figure.savefig(partial, **options)
    return Path(path)


def write_figures(folder: Path, figures: Mapping[str, Figure], **options: Any) -> list[Path]:
    """Write figures by file name into a folder; return their paths."""
    return [write_figure(folder / name, figure, **options) for name, figure in figures.items()]


def chart_figure(
    chart: Chart, title: str, size: tuple[float, float], *, letters: int | None = None
) -> Figure:
    """A figure of a chart with its legend and a title. size: inches; letters: see `draw`."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.add_subplot()
        draw(axes, chart, letters=letters)
        axes.legend(frameon=False, fontsize=8)
        axes.set_title(title, fontsize=9, loc="left")
    return figure
