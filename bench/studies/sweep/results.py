"""Files of a sweep's folder in addition to the table: summary and figures."""

from collections.abc import Sequence
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.studies.sweep.journal import OK
from bench.studies.sweep.plan import Plan
from bench.studies.sweep.run_sweep import FILE, TABLE
from bench.studies.sweep.summary import Summary, summarise, summary_markdown
from bench.studies.sweep.sweep_file import PlotTable, load_sweep
from bench.studies.sweep.table import column_names, read_table

SUMMARY = "summary.md"


def table_in(folder: Path) -> Path:
    """The table of a sweep, from its folder or its path. Raises BenchError if there is none."""
    path = folder if folder.is_file() else folder / TABLE
    if not path.is_file():
        raise BenchError(f"{folder}: holds no {TABLE}: name the folder of a sweep that has ended")
    return path


def failed_runs(table: Path) -> dict[str, list[int]]:
    """Numbers of the failed runs by reason, the most frequent first."""
    columns = read_table(table, ["run", "status", "reason"])
    reasons: dict[str, list[int]] = {}
    for run, status, reason in zip(*columns.values(), strict=True):
        if status != OK:
            reasons.setdefault(str(reason), []).append(run)
    return dict(sorted(reasons.items(), key=lambda item: -len(item[1])))


def write_table_summary(table: Path, axes: Sequence[str], metrics: Sequence[str]) -> tuple[Summary, Path]:
    """Write the summary of a table by some axes as Markdown next to the table; return the summary and the file."""
    summary = summarise(table, axes, metrics, in_parts=True)
    name = " ".join(metrics) + (f" by {' '.join(axes)}" if axes else "")
    path = table.with_name(f"{_file_name(name)}.md")
    write_text_atomically(path, summary_markdown(summary))
    return summary, path


def pooled_axes(table: Path, axes: Sequence[str]) -> dict[str, int]:
    """Axes of the sweep that a summary by `axes` pools, with their number of values; empty for a table without a
    sweep.
    """
    file = table.with_name(FILE)
    if not file.is_file():
        return {}
    plan = Plan(load_sweep(file))
    return {
        axis.name: len(axis.points)
        for axis in plan.sweep.grid
        if axis.name not in axes and len(axis.points) > 1
    }


def write_summary(plan: Plan, folder: Path) -> Summary:
    """Write summary.md by all axes of the grid, with the metrics that the sweep's file requests."""
    table = folder / TABLE
    known = column_names(table)
    metrics = [metric for metric in plan.sweep.table.show if metric in known]
    axes = [axis.name for axis in plan.sweep.grid]
    summary = summarise(table, axes, metrics)
    heading = f"# {plan.sweep.name}\n\n{plan.sweep.table.description}\n\n"
    write_text_atomically(folder / SUMMARY, heading + summary_markdown(summary))
    return summary


def write_plots(plan: Plan, folder: Path) -> list[Path]:
    """Draw the figures that the sweep's file requests, or those of `default_plots`."""
    from bench.studies.sweep.plot import plot_sweep  # noqa: PLC0415 - a table can be read without matplotlib

    table = folder / TABLE
    known = column_names(table)
    paths = []
    for plot in plan.sweep.table.plots or default_plots(plan):
        if plot.y in known:
            paths.append(folder / plot_name(plot.x, plot.y, plot.lines))
            plot_sweep(table, paths[-1], plot.x, plot.y, plot.lines)
    return paths


def default_plots(plan: Plan) -> Sequence[PlotTable]:
    """The first two metrics against the axis with the most values, a line for each value of the next.

    If no grid axis varies, against a drawn axis or the seed; empty if there is only one run.
    """
    axes = sorted(
        (axis for axis in plan.sweep.grid if len(axis.points) > 1), key=lambda axis: -len(axis.points)
    )
    shown = plan.sweep.table.show[:2]
    if axes:
        lines = axes[1].name if len(axes) > 1 else None
        return [PlotTable(x=axes[0].name, y=metric, lines=lines) for metric in shown]
    if len(plan.sweep.seeds) < 2:
        return []
    grid = {axis.name for axis in plan.sweep.grid}
    drawn = [name for name in plan.axis_names if name not in grid]
    return [PlotTable(x=(*drawn, "seed")[0], y=metric) for metric in shown]


def plot_name(x: str, y: str, lines: str | None = None) -> str:
    """File name of a figure."""
    name = f"{y} against {x}" + (f" by {lines}" if lines else "")
    return f"{_file_name(name)}.svg"


def _file_name(text: str) -> str:
    return "".join(letter if letter.isalnum() or letter in "._-" else "_" for letter in text)
