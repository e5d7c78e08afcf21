"""`bench diagnose`: which physical effects a model lacks."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.last_lines import after_diagnosis, say, shown, take_all, write_with_words, wrote
from bench.cli.options import (
    Asked,
    dataset_argument,
    effect_file_option,
    filter_options,
    in_existing_folder,
    json_option,
    output_option,
    path_option,
    rule_option,
    with_option,
)
from bench.cli.progress import quiet_option, shown_progress

if TYPE_CHECKING:
    from bench.basics.progress import Progress
    from bench.dataset.dataset import Dataset
    from bench.diagnosis.result import Diagnosis
    from bench.page.section_run import CommandRun


@click.command("diagnose")
@dataset_argument
@with_option
@effect_file_option
@filter_options
@json_option
@path_option(
    "--apply",
    "model_file",
    metavar="MODEL.json",
    callback=in_existing_folder,
    help="Write the model with the missing effects, and each discovered law as an effect file next to it.",
)
@click.option(
    "--discover/--no-discover",
    default=None,
    help="Search for laws outside the catalogue. [default: if the catalogue leaves an unexplained error]",
)
@click.option(
    "--time-limit",
    type=click.FloatRange(min=0.0, min_open=True),
    metavar="SECONDS",
    help="Return the best answer after this time, with a list of what was not searched. [default: 600]",
)
@rule_option
@output_option("Folder for report and figures.")
@quiet_option
@click.option("-v", "--verbose", is_flag=True, help="Print every effect and every parameter.")
def diagnose(  # noqa: PLR0913, PLR0917 - an argument for each option
    dataset: Path,
    json_file: Path | None,
    model_file: Path | None,
    output: Path | None,
    verbose: bool,
    quiet: bool,
    discover: bool | None,
    time_limit: float | None,
    rule: tuple[str, ...],
    asked: Asked,
) -> None:
    """Name the physical effects that a model lacks, with evidence.

    Every effect of the catalogue, and every small set of effects, is added to the model, fitted, and judged on
    recordings that were not fitted: those that the dataset reserves for validation, or the end of each recording.
    If an unexplained error remains, laws outside the catalogue compete with the effects: products of variables of a
    joint, its neighbours, the tool and the clock. A residual that no formula fits is added as a table.
    """
    with shown_progress(quiet) as progress:
        from bench.api.diagnose import TIME_LIMIT
        from bench.api.diagnose import diagnose as diagnosed
        from bench.dataset.dataset import load_dataset
        from bench.identification.given_rule import given_rule

        decides, tolerances = given_rule(rule)
        progress.phase("reading the recordings")
        data = load_dataset(dataset)
        diagnosis = diagnosed(
            data,
            asked.effects,
            filters=asked.filters,
            effect_files=asked.files,
            discover=discover,
            progress=progress,
            time_limit=TIME_LIMIT if time_limit is None else time_limit,
            rule=decides,
            tolerances=tolerances,
        )
    outcome = _Outcome(diagnosis, data, asked.files)
    command = asked.run(
        "diagnose", dataset, {**asked.filters, "time_limit": time_limit, "rule": rule or None}
    )
    take_all(
        lambda: outcome.write_laws(model_file),
        lambda: outcome.write_answer(json_file),
        lambda: outcome.write_model(model_file),
        lambda: outcome.show(verbose=verbose),
        lambda: outcome.draw(output, command, quiet=quiet),
        lambda: outcome.say_next(command, model_file),
    )


class _Outcome:
    """Writes a diagnosis to files and terminal. written: lines on written files; laws: files of discovered laws."""

    def __init__(self, diagnosis: "Diagnosis", data: "Dataset", effect_files: tuple[Path, ...]) -> None:
        self.diagnosis, self.data, self.effect_files = diagnosis, data, effect_files
        self.written: list[str] = []
        self.laws: list[Path] = []

    def write_laws(self, model: Path | None) -> None:
        """Write discovered laws next to the model file, and store the names of these files in the diagnosis."""
        if model is None:
            return
        from bench.diagnosis.discovery.law_files import write_laws

        self.diagnosis = write_laws(self.diagnosis, model.parent)
        names = dict.fromkeys(law.file for law in self.diagnosis.discovered if law.file is not None)
        self.laws = [model.parent / name for name in names]
        self.written += [wrote(path, "law: use it with --effect-file") for path in self.laws]

    def write_answer(self, file: Path | None) -> None:
        """Write the answer as JSON."""
        from bench.diagnosis.as_json import diagnosis_json

        write_with_words(file, partial(diagnosis_json, self.diagnosis), "diagnosis", self.written)

    def write_model(self, file: Path | None) -> None:
        """Write the model with the missing effects."""
        if file is None:
            return
        from bench.identification.model_file import save_model

        save_model(self.diagnosis.after, file, self.data.folder, [*self.effect_files, *self.laws])
        self.written.append(wrote(file, "model with the missing effects"))

    def show(self, *, verbose: bool) -> None:
        """Print the report, or only the values if the report fails."""
        from rich.console import Console

        from bench.diagnosis.as_json import verdict_json
        from bench.document.terminal.diagnosis import diagnosis_report

        shown(
            lambda: diagnosis_report(self.diagnosis, Console(), verbose=verbose),
            lambda: verdict_json(self.diagnosis),
        )

    def draw(self, folder: Path | None, command: "CommandRun", *, quiet: bool) -> None:
        """Draw figures and page."""
        if folder is None:
            return
        with shown_progress(quiet, "drawing figures") as progress:
            take_all(lambda: self._draw_figures(folder), lambda: self._draw_page(folder, command, progress))

    def _draw_figures(self, folder: Path) -> None:
        from bench.diagnosis.split import dataset_of
        from bench.document.figures.diagnosis import write_diagnosis_figures
        from bench.residuals.motor import compared

        after = self.diagnosis.after
        logged = dataset_of(self.data, after.recordings).recordings
        errors = compared(self.data.robot, logged, after.recordings, after.settings)
        drawn = write_diagnosis_figures(folder, self.diagnosis, errors)
        self.written += [wrote(path, "figure") for path in drawn]

    def _draw_page(self, folder: Path, command: "CommandRun", progress: "Progress") -> None:
        from bench.page.write import write_diagnosis_report

        run = replace(command, output=str(folder))
        page = write_diagnosis_report(folder, self.diagnosis, self.data, run, progress)
        self.written.append(wrote(page, "report"))

    def say_next(self, command: "CommandRun", model: Path | None) -> None:
        """Print the written files and the suggested next command."""
        files = (*self.effect_files, *self.laws)
        step = after_diagnosis(self.diagnosis, Path(command.dataset), command.line(), model, files)
        say([*self.written, step])
