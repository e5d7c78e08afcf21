"""`bench plot`: a figure of a sweep."""

from pathlib import Path

import click

from bench.cli.last_lines import next_line, say, wrote


@click.command("plot")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--x", "x", required=True, metavar="AXIS", help="Axis of the abscissa.")
@click.option("--y", "y", required=True, metavar="METRIC", help="Metric to plot: median and middle 90 %.")
@click.option("--lines", metavar="AXIS", help="A line for each value of this axis.")
@click.option("--log/--linear", "logarithmic", default=None, help="Axis of METRIC. [default: by its range]")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="An .svg, .png or .pdf file. [default: named after the axes, in DIR]",
)
def plot(
    folder: Path, x: str, y: str, lines: str | None, logarithmic: bool | None, output: Path | None
) -> None:
    """Draw a metric of a sweep against an axis.

    DIR is the folder of a sweep.
    """
    from bench.studies.sweep.plot import plot_sweep
    from bench.studies.sweep.rerun_runs import is_sweep_folder
    from bench.studies.sweep.results import plot_name, table_in

    table = table_in(folder)
    path = output or table.with_name(plot_name(x, y, lines))
    plot_sweep(table, path, x, y, lines, logarithmic=logarithmic)
    seen = next_line(["view", folder], "shows a good, a median and a bad run in motion")
    say([wrote(path, "figure"), *([seen] if is_sweep_folder(folder) else [])])
