"""`bench compare`: where a model fails."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.cli.last_lines import next_line, say, shown, take_all, write_with_words, wrote
from bench.cli.options import (
    Asked,
    dataset_argument,
    effect_file_option,
    filter_options,
    json_option,
    output_option,
    path_option,
    with_option,
)

if TYPE_CHECKING:
    from bench.cli.next_steps import Source
    from bench.residuals.motor import Compared


@click.command("compare")
@dataset_argument
@path_option(
    "--model",
    "model_files",
    multiple=True,
    metavar="MODEL.json",
    help="What `bench identify --json` wrote. Repeat for models side by side. [default: identified from DATASET]",
)
@with_option
@effect_file_option
@filter_options
@json_option
@output_option(
    "Folder for report and figures of one model: the currents, and a page of errors for every motor."
)
def compare(
    dataset: Path,
    model_files: tuple[Path, ...],
    json_file: Path | None,
    output: Path | None,
    asked: Asked,
) -> None:
    """Describe and plot where a model fails on a dataset's recordings.

    A saved model is applied unchanged, without a fit. Without one, the model (with the named effects) is identified
    from the recordings that the dataset reserves for it. Several models are compared side by side: errors, drive
    gains with intervals, and changes.
    """
    if model_files and (asked.effects or asked.filters):
        raise click.UsageError("--model already contains effects and filters; omit the other options")
    if len(model_files) > 1:
        if output is not None:
            raise click.UsageError("-o needs a single model")
        _side_by_side(dataset, model_files, asked, json_file)
    else:
        _of_one(dataset, model_files[0] if model_files else None, asked, json_file, output)


def _of_one(
    dataset: Path, model_file: Path | None, asked: Asked, json_file: Path | None, output: Path | None
) -> None:
    from rich.console import Console

    from bench.api.compare import compare as errors_of
    from bench.cli.next_steps import Source
    from bench.dataset.dataset import load_dataset
    from bench.document.terminal.identification import comparison_report, where_report
    from bench.identification.model_file import comparison_json, load_model
    from bench.residuals.as_json import where_json

    data = load_dataset(dataset)
    errors = errors_of(data, model_file, asked.effects, filters=asked.filters, effect_files=asked.files)
    console, written = Console(), list[str]()

    def answer(words: bool = True) -> dict[str, Any]:
        return {**comparison_json(errors.comparison, words=words), **where_json(errors.where, words=words)}

    def report() -> None:
        comparison_report(errors.comparison, console)
        where_report(errors.where, console)

    def figures() -> None:
        if output is not None:
            from bench.document.figures.comparison import write_comparison_figures

            written.extend(wrote(path, "figure") for path in write_comparison_figures(output, errors.motors))

    def page() -> None:
        if output is None:
            return
        from bench.page.write import write_identification_report

        name = "" if model_file is None else str(model_file)
        options, result = asked.filters | ({"model": name} if name else {}), errors.identified
        if result is None and model_file is not None:
            result = load_model(model_file).applied_to(data, errors.recordings)
        run = asked.run("compare", dataset, options, output)
        if result is not None:
            written.append(wrote(write_identification_report(output, result, data, run, name), "report"))

    source = Source(dataset, replace(asked, effects=errors.effects))
    take_all(
        lambda: write_with_words(json_file, answer, "comparison", written),
        lambda: shown(report, lambda: comparison_json(errors.comparison, words=False)),
        figures,
        page,
        lambda: say([*written, _next(source, errors.motors, model_file)]),
    )


def _next(source: "Source", what: "Compared", model_file: Path | None) -> str:
    """The suggested next command after a comparison."""
    from bench.cli.next_steps import after_errors

    if (step := after_errors(source, what, kept=model_file is not None)) is not None or model_file is None:
        return step or ""
    target = model_file.with_suffix(".xml")
    return next_line(["export", model_file, "--to", "mjcf", "-o", target], "exports the model to a simulator")


def _side_by_side(dataset: Path, model_files: tuple[Path, ...], asked: Asked, json_file: Path | None) -> None:
    """Compare several models on the same recordings."""
    from rich.console import Console

    from bench.dataset.dataset import load_dataset
    from bench.document.side_by_side import changed_sentences
    from bench.document.terminal.identification import side_by_side_report
    from bench.residuals.side_by_side import side_by_side, side_by_side_json

    comparison = side_by_side(asked.of(load_dataset(dataset)), model_files)
    written: list[str] = []

    def answer(words: bool = True) -> dict[str, Any]:
        return side_by_side_json(comparison, changed_sentences(comparison) if words else ())

    step = next_line(["compare", dataset, "--model", model_files[-1]], "shows where this one fails")
    take_all(
        lambda: write_with_words(json_file, answer, "comparison", written),
        lambda: shown(
            lambda: side_by_side_report(comparison, changed_sentences(comparison), Console()),
            lambda: answer(words=False),
        ),
        lambda: say([*written, step]),
    )
