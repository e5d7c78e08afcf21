"""`bench diagnose`: which physical effects a model lacks."""

from pathlib import Path
from typing import Any

import click

from bench.cli.options import (
    dataset_argument,
    effect_file_option,
    filter_options,
    given_filters,
    in_existing_folder,
    json_option,
    output_option,
    with_option,
)


@click.command("diagnose")
@dataset_argument
@with_option
@effect_file_option
@filter_options
@json_option
@click.option(
    "--apply",
    "model_file",
    type=click.Path(path_type=Path),
    metavar="MODEL.json",
    callback=in_existing_folder,
    help="Write the model with what is missing.",
)
@output_option("Folder for report and figures.")
@click.option("-v", "--verbose", is_flag=True, help="Print every effect and every parameter.")
def diagnose(
    dataset: Path,
    effects: tuple[str, ...],
    effect_files: tuple[Path, ...],
    json_file: Path | None,
    model_file: Path | None,
    output: Path | None,
    verbose: bool,
    **filters: Any,
) -> None:
    """Find the physical effects that a model lacks, and how sure it is.

    Every effect of the catalogue, and every set of a few, is fitted beside the model and judged on recordings
    that were not fitted: those that the dataset keeps for validation, or the end of each recording.
    """
    from dataclasses import replace

    from rich.console import Console

    from bench.dataset import load_dataset
    from bench.diagnose.as_json import diagnosis_json
    from bench.diagnose.find import find_missing_effects
    from bench.estimate.model_file import save_model
    from bench.estimate.swapped import swapped_notes
    from bench.files import write_json_atomically
    from bench.show.diagnosis import diagnosis_report
    from bench.signals.shortness import shortness_notes

    data = load_dataset(dataset)
    given = given_filters(**filters)
    diagnosis = find_missing_effects(data, effects, filters=given, effect_files=effect_files)
    short = shortness_notes(data.recordings, diagnosis.after.settings)
    swapped = swapped_notes(data, diagnosis.before)
    notes = (*swapped, *diagnosis.after.notes, *short)
    diagnosis = replace(diagnosis, after=replace(diagnosis.after, notes=notes))
    diagnosis_report(diagnosis, Console(), verbose=verbose)
    if json_file is not None:
        write_json_atomically(json_file, diagnosis_json(diagnosis))
        click.echo(f"Diagnosis: {json_file}")
    if model_file is not None:
        save_model(diagnosis.after, model_file, data.folder)
        click.echo(f"Model: {model_file}")
    if output is not None:
        from bench.show.diagnosis_figures import write_diagnosis_figures

        for path in write_diagnosis_figures(output, diagnosis, data):
            click.echo(f"Figure: {path}")

        from bench.report.content_run import Run
        from bench.report.write import write_diagnosis_report

        run = Run("diagnose", str(dataset), effects, tuple(map(str, effect_files)), given, str(output))
        click.echo(f"Report: {write_diagnosis_report(output, diagnosis, data, run)}")
