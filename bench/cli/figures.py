"""`bench figures`: figures for papers, with the numbers behind them."""

from pathlib import Path
from typing import Any

import click

from bench.cli.last_lines import say, wrote
from bench.cli.options import effect_file_option, filter_options, given_filters, with_option


@click.command("figures")
@click.argument("source", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    required=True,
    metavar="DIR",
    help="Folder for PDF, PNG and CSV.",
)
@click.option(
    "--only",
    multiple=True,
    metavar="NAME",
    help="Figures whose names begin so, such as error_by or ladder. Repeat for each. [default: all]",
)
@click.option(
    "--data",
    type=click.Path(path_type=Path),
    metavar="DATASET",
    help="The recordings beside which a model file is shown. [default: those that it is from]",
)
@with_option
@effect_file_option
@filter_options
def figures(
    source: Path,
    output: Path,
    only: tuple[str, ...],
    data: Path | None,
    effects: tuple[str, ...],
    effect_files: tuple[Path, ...],
    **filters: Any,
) -> None:
    """Draw figures for papers, with the numbers behind them.

    SOURCE is a dataset, which is identified (with the effects named); a model file of `bench identify --json`; or a
    folder that `bench identify`, `compare` or `diagnose` wrote with -o. Ladder, ranking and gains before and after
    come from a diagnosis.

    Each figure comes as PDF and PNG for one column (88 mm) and for two (180 mm), with its numbers as CSV.
    """
    from bench.api.figures import figures_of
    from bench.basics.errors import BenchError
    from bench.cli.named_sources import Asked, answer_of
    from bench.document.figures.paper import write_paper_figures

    given = given_filters(**filters)
    dataset, result, diagnosis = answer_of(source, Asked(effects, effect_files, given, data))
    found = figures_of(dataset, result, diagnosis)
    chosen = [one for one in found if not only or one.name.startswith(only)]
    if not chosen:
        names = ", ".join(one.name for one in found)
        raise BenchError(f"--only {' --only '.join(only)}: no such figure; there are {names}")
    for path in write_paper_figures(output, chosen):
        say([wrote(path, "figure" if path.suffix != ".csv" else "numbers")])
