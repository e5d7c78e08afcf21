"""`bench compare`: a saved model beside other recordings."""

from pathlib import Path

import click

from bench.cli.options import dataset_argument, effect_file_option, json_option


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
@effect_file_option
@json_option
def compare(dataset: Path, model_file: Path, effect_files: tuple[Path, ...], json_file: Path | None) -> None:
    """Apply a saved model to a dataset's recordings; nothing is fitted."""
    import json

    from rich.console import Console

    from bench.dataset import load_dataset
    from bench.effects import catalogue_for
    from bench.estimate.model_file import apply_model, comparison_json, load_model
    from bench.files import write_text_atomically
    from bench.show.tables import comparison_report

    data = load_dataset(dataset)
    comparison = apply_model(data, load_model(model_file), catalogue_for(data.effect_files, effect_files))
    comparison_report(comparison, Console())
    if json_file is not None:
        write_text_atomically(json_file, json.dumps(comparison_json(comparison), indent=1) + "\n")
        click.echo(f"Comparison: {json_file}")
