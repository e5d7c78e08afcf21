"""A chart of a sweep as a file: a metric against an axis."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from bench.basics.figure_style import STYLE
from bench.document.figures.draw import draw
from bench.document.figures.write import write_figure
from bench.studies.sweep.charts import plot_chart

MANY_NAMES = 6  # along x: this many or more are slanted


def plot_sweep(
    table: Path, path: Path, x: str, y: str, lines: str | None = None, *, logarithmic: bool | None = None
) -> None:
    """Draw `plot_chart` into a file (.png, .svg or .pdf). Raises BenchError if the table has no such column."""
    chart = plot_chart(table, x, y, lines, logarithmic=logarithmic)
    with mpl.rc_context({**STYLE, "svg.hashsalt": "bench", "svg.fonttype": "none"}):
        figure = Figure(figsize=(7.0, 4.4), layout="constrained")
        axes = figure.add_subplot()
        draw(axes, chart)
        if len(chart.x.categories) >= MANY_NAMES:
            axes.tick_params(axis="x", rotation=30)
        axes.set_title(chart.aid, fontsize=8, color="#555555", wrap=True)
        if lines is not None:
            axes.legend(frameon=False, fontsize=8)
        write_figure(path, figure, dpi=150, metadata={"Date": None} if path.suffix == ".svg" else None)
