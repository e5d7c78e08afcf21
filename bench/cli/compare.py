"""`bench compare`: a saved model beside other recordings."""

from pathlib import Path

import click

from bench.cli.options import dataset_argument, json_option


@click.command("compare")
@dataset_argument
@click.option(
    "--model",
    "model_file",
    type=click.Path(path_type=Path),
    required=True,
    metavar="MODEL.json",
    help="What `bench identify --json` wrote.",
)
@json_option
def compare(dataset: Path, model_file: Path, json_file: Path | None) -> None:
    """Apply a saved model to a dataset's recordings; nothing is fitted."""
    import json

    from rich.console import Console

    from bench.dataset import load_dataset
    from bench.estimate.model_file import apply_model, comparison_json, load_model
    from bench.files import write_text_atomically
    from bench.show.tables import comparison_report

    comparison = apply_model(load_dataset(dataset), load_model(model_file))
    comparison_report(comparison, Console())
    if json_file is not None:
        write_text_atomically(json_file, json.dumps(comparison_json(comparison), indent=1) + "\n")
        click.echo(f"Comparison: {json_file}")
