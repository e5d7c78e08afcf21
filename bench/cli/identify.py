"""`bench identify`: from recordings to drive gains and dynamic parameters."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.cli.last_lines import (
    AGAIN,
    STANDARD_OUTPUT,
    next_line,
    say,
    shown,
    take_all,
    write_with_words,
    wrote,
)
from bench.cli.options import (
    Asked,
    dataset_argument,
    effect_file_option,
    filter_options,
    in_existing_folder,
    json_option,
    output_option,
    path_option,
    with_option,
)
from bench.identification.estimators import DEFAULT_METHOD, ESTIMATORS

if TYPE_CHECKING:
    from bench.identification.result import Identification


@click.command("identify")
@dataset_argument
@with_option
@effect_file_option
@click.option(
    "--method",
    type=click.Choice(list(ESTIMATORS)),
    default=DEFAULT_METHOD,
    show_default=True,
    help="The estimator.",
)
@click.option(
    "--gains",
    type=click.Choice(["auto", "fit", "nominal"]),
    default="auto",
    show_default=True,
    help="Fit the drive gains if a payload of known mass fixes their scale, or keep them nominal.",
)
@click.option("--essential", is_flag=True, help="Omit base parameters that the data do not need.")
@click.option("--physical", is_flag=True, help="Restrict the fit to physically possible parameters.")
@click.option(
    "--deviations",
    type=click.Choice(["autocorrelated", "independent"]),
    default="autocorrelated",
    show_default=True,
    help="Standard errors for residuals that are correlated from one sample to the next, or by the customary formula.",
)
@filter_options
@json_option
@path_option(
    "--rrd", "rrd_file", metavar="FILE", callback=in_existing_folder, help="Write a Rerun recording."
)
@output_option("Folder for the report.")
@click.option("-v", "--verbose", is_flag=True, help="Print groupings in full.")
def identify(  # noqa: PLR0913, PLR0917 - an argument for each option
    dataset: Path,
    method: str,
    gains: str,
    essential: bool,
    physical: bool,
    deviations: Any,
    json_file: Path | None,
    rrd_file: Path | None,
    output: Path | None,
    verbose: bool,
    asked: Asked,
) -> None:
    """Identify drive gains and dynamic parameters from a dataset.

    DATASET is a folder with a dataset.toml. If one recording carries a payload of known mass and another none,
    the drive gains are identified as well.
    """
    from rich.console import Console

    from bench.api.identify import identify as identified
    from bench.cli.next_steps import Source, after_errors
    from bench.dataset.dataset import load_dataset
    from bench.document.terminal.identification import identification_report
    from bench.identification.finding import to_mend
    from bench.identification.model_file import model_json
    from bench.residuals.motor import compared
    from bench.residuals.words import beyond_noise, remaining_errors

    data = load_dataset(dataset)
    result = identified(
        data,
        asked.effects,
        method,
        filters=asked.filters,
        effect_files=asked.files,
        deviations=deviations,
        fit_gains={"auto": None, "fit": True, "nominal": False}[gains],
        essential=essential,
        physical=physical,
    )
    written: list[str] = []
    folder = json_file.resolve().parent if json_file and json_file != STANDARD_OUTPUT else None
    answer = partial(model_json, result, data.folder, asked.files, folder)

    report = partial(identification_report, result, Console(), verbose=verbose)

    def recording() -> None:
        if rrd_file is None:
            return
        from bench.viewer.recording import write_rrd

        write_rrd(rrd_file, result, data)
        written.append(wrote(rrd_file, f"recording: open it with rerun {rrd_file}"))

    def page() -> None:
        if output is None:
            return
        from bench.page.write import write_identification_report

        options = {"method": method, "gains": gains, "essential": essential, "physical": physical}
        options |= {"deviations": deviations, **asked.filters}
        command = asked.run("identify", dataset, options, output)
        written.append(wrote(write_identification_report(output, result, data, command), "report"))

    def last_lines() -> None:
        what = compared(data.robot, data.recordings, result.recordings, result.settings)
        source = Source(dataset, asked)
        step = after_errors(source, what, kept=json_file not in (None, STANDARD_OUTPUT))
        if to_mend(result.findings, error_left=beyond_noise(what)):
            step = f"next: {source.command('identify', dataset)}    {AGAIN}"
        if step is None:
            step = next_line(["compare", dataset, "--model", str(json_file)], "shows its errors by motor")
        say([*remaining_errors(what), *written, step])

    take_all(
        lambda: write_with_words(json_file, answer, "model", written),
        lambda: shown(report, lambda: _gains(result)),
        recording,
        page,
        last_lines,
    )


def _gains(result: "Identification") -> dict[str, Any]:
    """The main values of an answer."""
    from bench.identification.model_json import to_json

    answer = to_json(result, words=False)
    return {key: answer[key] for key in ("robot", "drive_gains", "parameters", "effect_parameters", "error")}
