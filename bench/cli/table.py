"""`bench table`: the runs of a sweep in a few numbers."""

from pathlib import Path

import click

from bench.basics.plural import plural
from bench.cli.last_lines import say, wrote


@click.command("table")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--by", "axes", multiple=True, metavar="AXIS", help="One row per value. Repeat for more axes.")
@click.option(
    "--show",
    "metrics",
    multiple=True,
    metavar="METRIC",
    help="Metric to summarise. Repeat for more. [default: gain_error]",
)
def table(folder: Path, axes: tuple[str, ...], metrics: tuple[str, ...]) -> None:
    """Summarise the runs of a sweep by axis.

    DIR is the folder of a sweep. Prints median and spread, and writes them to the folder as Markdown. Every
    column of the table can be an axis, and every column of numbers a metric.
    """
    from bench.cli.next_steps import after_table
    from bench.studies.sweep.console import table_console
    from bench.studies.sweep.print_summary import print_summary
    from bench.studies.sweep.results import pooled_axes, table_in, write_table_summary

    runs = table_in(folder)
    metrics = metrics or ("gain_error",)
    summary, path = write_table_summary(runs, axes, metrics)
    print_summary(summary, table_console())
    pooled = pooled_axes(runs, axes)
    values = ", ".join(f"{name} ({plural(count, 'value')})" for name, count in pooled.items())
    messages = [f"values of {values} are pooled; --by separates them"] if pooled else []
    say([*messages, wrote(path, "summary"), after_table(folder, axes, metrics, tuple(pooled))])
