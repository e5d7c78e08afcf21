"""`bench report`: a page in one file on a dataset, a result, a model, a sweep or a trial."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.basics.progress import Progress
from bench.cli.last_lines import say, wrote
from bench.cli.options import (
    Asked,
    data_option,
    effect_file_option,
    file_or_folder,
    filter_options,
    output_option,
    with_option,
)
from bench.cli.progress import quiet_option, shown_progress
from bench.dataset.names import DATASET_FILE, RUN_FILE

if TYPE_CHECKING:
    from bench.cli.next_steps import Source
    from bench.diagnosis.result import Diagnosis


@click.command("report")
@click.argument("source", metavar="DIR_OR_MODEL", type=click.Path(path_type=Path))
@output_option(
    "The file to write.",
    default=Path("report.html"),
    show_default=True,
    metavar="FILE.html",
    callback=file_or_folder,
)
@data_option
@with_option
@effect_file_option
@filter_options
@quiet_option
def report(
    source: Path,
    output: Path,
    data: Path | None,
    quiet: bool,
    asked: Asked,
) -> None:
    """Write a one-file page with the results of a run.

    DIR_OR_MODEL is a dataset folder, which is diagnosed; or a folder that `bench diagnose -o`, `identify -o`,
    `compare -o`, `sweep -o` or `trial -o` wrote; or a model file. The page opens in any browser, offline.
    """
    with shown_progress(quiet) as progress:
        from bench.cli.next_steps import Source
        from bench.page.write import REPORT_FILE

        output = output / REPORT_FILE if output.is_dir() else output
        said, step = _written(Source(source, asked, data), output, progress)
    if said:
        click.echo(said, err=True)
    say([wrote(output, "report"), step])


def _written(given: "Source", output: Path, progress: Progress) -> tuple[str, str]:
    """Write the page of the source; returns a note on what had to be computed again, or "", and the next step."""
    from bench.basics.errors import BenchError
    from bench.cli.next_steps import after_page, after_trial
    from bench.dataset.dataset import refuse_log
    from bench.page.folder import read_run
    from bench.page.write import write_saved_run
    from bench.studies.sweep.rerun_runs import is_sweep_folder

    said, source, data, asked = "", given.path, given.data, given.asked
    models: dict[str, Any] = {"--data": data, "--with": asked.effects, "--effect-file": asked.files}
    models |= {"filters": asked.filters}
    if (source / DATASET_FILE).is_file() or source.name == DATASET_FILE:
        _refuse({"--data": data}, "a dataset, which is diagnosed")
        return said, after_page(given, _of_dataset(given, output, progress))
    if (source / RUN_FILE).is_file():
        _refuse(models, "a result")
        progress.phase("reading the result")
        kept = read_run(source)
        write_saved_run(output, kept, source, progress)
        said = kept.said
    elif is_sweep_folder(source):
        _refuse(models, "a sweep")
        from bench.page.write_studies import write_sweep_report

        progress.phase("drawing the page of a sweep")
        write_sweep_report(source, output)
    elif source.is_dir() or source.suffix == ".parquet":
        _refuse(models, "a trial")
        progress.phase("drawing the page of a trial")
        return said, after_trial(_of_trial(source, output))
    elif source.is_file():
        refuse_log(source)
        _refuse({"--with": asked.effects, "filters": asked.filters}, "a model file")
        _of_model(given, output, progress)
    else:
        raise BenchError(f"{source}: no such file or folder")
    return said, after_page(given, None)


def _refuse(options: dict[str, Any], what: str) -> None:
    for name, value in options.items():
        if value:
            raise click.UsageError(f"{name} cannot be combined with {what}")


def _of_trial(source: Path, output: Path) -> Path:
    from bench.basics.errors import BenchError
    from bench.page.trial_page import trial_table
    from bench.page.write_studies import write_trial_report

    table = trial_table(source) if source.exists() else None
    if table is None:
        why = "not the table of a trial" if source.exists() else "no such file or folder"
        if source.is_dir():
            why = f"neither a dataset nor a result: it has no dataset.toml, no {RUN_FILE}, and no sweep or trial"
        raise BenchError(f"{source}: {why}")
    write_trial_report(table, output)
    return table


def _of_dataset(given: "Source", output: Path, progress: Progress) -> "Diagnosis":
    from bench.api.diagnose import diagnose
    from bench.cli.last_lines import shown
    from bench.dataset.dataset import load_dataset
    from bench.diagnosis.as_json import verdict_json
    from bench.page.folder import SavedRun
    from bench.page.write import write_saved_run

    progress.phase("reading the recordings")
    asked, dataset = given.asked, load_dataset(given.path)
    diagnosis = diagnose(
        dataset, asked.effects, filters=asked.filters, effect_files=asked.files, progress=progress
    )
    run = asked.run("report", given.path, output=output)
    kept = SavedRun(run, dataset, diagnosis.after, diagnosis, "")
    shown(lambda: write_saved_run(output, kept, progress=progress), lambda: verdict_json(diagnosis))
    return diagnosis


def _of_model(given: "Source", output: Path, progress: Progress) -> None:
    from bench.page.folder import SavedRun
    from bench.page.write import write_saved_run

    progress.phase("reading the recordings")
    dataset, result = given.applied()
    run = given.asked.run("report", given.path, {"data": str(given.dataset)}, output)
    write_saved_run(output, SavedRun(run, dataset, result, None, str(given.path)), progress=progress)
