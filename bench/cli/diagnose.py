"""`bench diagnose`: which physical effects a model lacks."""

from pathlib import Path
from typing import Any

import click

from bench.cli.last_lines import after_diagnosis, say, write_answer, wrote
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
from bench.cli.progress import quiet_option, shown_progress


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
    help="Write the model with what is missing, and every law that was discovered as an effect of your own beside it.",
)
@click.option(
    "--discover/--no-discover",
    default=None,
    help="Look for laws that are in no catalogue; by default where its effects leave something.",
)
@output_option("Folder for report and figures.")
@quiet_option
@click.option("-v", "--verbose", is_flag=True, help="Print every effect and every parameter.")
def diagnose(
    dataset: Path,
    effects: tuple[str, ...],
    effect_files: tuple[Path, ...],
    json_file: Path | None,
    model_file: Path | None,
    output: Path | None,
    verbose: bool,
    quiet: bool,
    discover: bool | None,
    **filters: Any,
) -> None:
    """Find the physical effects that a model lacks, and how sure it is.

    Every effect of the catalogue, and every set of a few, is fitted beside the model and judged on recordings
    that were not fitted: those that the dataset keeps for validation, or the end of each recording. Where they
    leave something, laws that are in no catalogue compete beside them: products of what a joint, its neighbours,
    the tool and the clock offer. What no formula fits is added as it was measured.
    """
    given = given_filters(**filters)
    with shown_progress(quiet) as progress:
        from bench.api.diagnose import diagnose as diagnosed
        from bench.dataset.dataset import load_dataset

        progress.phase("reading the recordings")
        data = load_dataset(dataset)
        diagnosis = diagnosed(
            data, effects, filters=given, effect_files=effect_files, discover=discover, progress=progress
        )
    written: list[str] = []
    laws: list[Path] = []
    if model_file is not None:
        from bench.diagnosis.discovery.written import write_laws

        diagnosis = write_laws(diagnosis, model_file.parent)
        names = dict.fromkeys(law.file for law in diagnosis.discovered if law.file is not None)
        laws = [model_file.parent / name for name in names]
        written += [wrote(path, "law: name it with --effect-file") for path in laws]
    if json_file is not None:
        from bench.diagnosis.as_json import diagnosis_json

        write_answer(json_file, diagnosis_json(diagnosis))
        written.append(wrote(json_file, "diagnosis"))
    if model_file is not None:
        from bench.identification.model_file import save_model

        save_model(diagnosis.after, model_file, data.folder, [*map(Path, effect_files), *laws])
        written.append(wrote(model_file, "model with what is missing"))
    from bench.page.section_run import CommandRun

    if output is not None:
        run = CommandRun("diagnose", str(dataset), effects, tuple(map(str, effect_files)), given, str(output))
        with shown_progress(quiet, "drawing figures") as progress:
            from bench.diagnosis.split import dataset_of
            from bench.document.figures.diagnosis import write_diagnosis_figures
            from bench.page.write import write_diagnosis_report
            from bench.residuals.motor import compared

            after = diagnosis.after
            logged = dataset_of(data, after.recordings).recordings
            left = compared(data.robot, logged, after.recordings, after.settings)
            written += [wrote(path, "figure") for path in write_diagnosis_figures(output, diagnosis, left)]
            page = write_diagnosis_report(output, diagnosis, data, run, progress)
            written.append(wrote(page, "report"))
    from rich.console import Console

    from bench.document.terminal.diagnosis import diagnosis_report

    diagnosis_report(diagnosis, Console(), verbose=verbose)
    again = CommandRun("diagnose", str(dataset), effects, tuple(map(str, effect_files)), given).line()
    say([*written, after_diagnosis(diagnosis, dataset, again, model_file, (*effect_files, *laws))])
