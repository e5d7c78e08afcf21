"""`bench figures`: figures for papers, with the numbers behind them."""

from pathlib import Path

import click

from bench.cli.last_lines import say, wrote
from bench.cli.options import Asked, data_option, effect_file_option, filter_options, path_option, with_option


@click.command("figures")
@click.argument("source", type=click.Path(path_type=Path))
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--all", "every", is_flag=True, help="Draw every figure.")
@path_option("-o", "--output", metavar="DIR", help="Folder for PDF, PNG and CSV.")
@click.option("--only", multiple=True, metavar="NAME", help="The same as NAME. Repeat for each.")
@data_option
@with_option
@effect_file_option
@filter_options
def figures(
    source: Path,
    names: tuple[str, ...],
    every: bool,
    output: Path | None,
    only: tuple[str, ...],
    data: Path | None,
    asked: Asked,
) -> None:
    """Draw figures for papers, with their numbers as CSV.

    SOURCE is a dataset, which is identified (with the effects named); a model file of `bench identify --json`; or a
    folder that `bench identify`, `compare` or `diagnose` wrote with -o. Ladder, ranking and gains before and after
    come from a diagnosis.

    NAME is a figure, or the beginning of several names, for example ladder or error_by. Without a NAME, this command
    lists them. Each figure comes as PDF and PNG for one column (88 mm) and for two (180 mm), with its numbers as CSV.
    """
    from bench.api.figures import figures_named, figures_of
    from bench.basics.errors import BenchError
    from bench.cli.named_sources import answer_of
    from bench.cli.next_steps import Source, after_figures, before_figures
    from bench.document.figures.paper import write_paper_figures

    wanted = (*names, *only)
    if every and wanted:
        raise click.UsageError("--all does not accept names of figures")
    if output is None and (every or wanted):
        raise click.UsageError("give the folder of the figures with -o DIR")
    there = Source(source, asked, data)
    drawable = figures_of(*answer_of(there))
    if output is None:
        for figure in drawable:
            click.echo(figure.name)
        say([before_figures(there, drawable[-1].name)])
        return
    if not every and not wanted:
        raise BenchError(
            f"figures: give the names of those to draw, or --all; available: "
            f"{', '.join(each.name for each in drawable)}"
        )
    written = [
        wrote(path, "figure" if path.suffix != ".csv" else "numbers")
        for path in write_paper_figures(output, figures_named(drawable, wanted))
    ]
    say([*written, after_figures(there)])
