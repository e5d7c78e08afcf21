"""`bench import`: a controller's log becomes a recording of a dataset."""

from pathlib import Path
from typing import Any

import click

from bench.cli.parameters import Assignment, number_or_word, unique

CHECKS = ("units", "limits", "constant", "spikes", "frozen", "saturated")


@click.command("import")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--robot", required=True, help="Built-in name, or path of a robot folder.")
@click.option(
    "--map",
    "mapping",
    type=Assignment(),
    multiple=True,
    metavar="COLUMN=NAME",
    help="The log's NAME becomes COLUMN: time, position.JOINT, current.JOINT, or one to keep for plots."
    " Repeat for each; a column that the log itself calls so needs none.",
)
@click.option(
    "--scale",
    type=Assignment(number_or_word),
    multiple=True,
    metavar="COLUMN=FACTOR",
    help="Multiply COLUMN to get SI units, or name its unit: time=ms, position.axis=1e-3, position=deg or"
    " current=mA for all joints.",
)
@click.option("--rate", type=float, metavar="HZ", help="Sampling rate of a log without a time column.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="DATASET",
    help="Dataset folder to make or to add to. [default: the log's name without its suffix]",
)
@click.option("--name", metavar="NAME.csv", help="The recording's file name, .csv or .parquet.")
@click.option(
    "--use",
    type=click.Choice(["identify", "validate"]),
    default="identify",
    show_default=True,
    help="Fit the recording, or only compare with it.",
)
@click.option(
    "--validate-fraction",
    type=float,
    default=0.0,
    metavar="PART",
    help="Keep the last PART (0 to 1) of the log apart, for validation.",
)
@click.option("--payload", metavar="NAME", help="The payload on the tool.")
@click.option(
    "--payload-mass", type=float, metavar="KG", help="Define the payload, weighed; its inertia is estimated."
)
@click.option(
    "--accept",
    type=click.Choice(CHECKS),
    multiple=True,
    help="Take a recording that fails this check all the same.",
)
def import_log(
    file: Path,
    robot: str,
    mapping: tuple[tuple[str, str], ...],
    scale: tuple[tuple[str, float | str], ...],
    rate: float | None,
    output: Path | None,
    payload: str | None,
    payload_mass: float | None,
    **settings: Any,
) -> None:
    """Turn a .mat, .csv, .npz or .parquet log into a dataset.

    \b
    bench import log.mat --robot emps \\
        --map time=t --map position.axis=qm --map current.axis=vir
    """
    if payload_mass is not None and payload is None:
        raise click.UsageError("--payload-mass needs --payload NAME")
    columns, factors = unique(mapping, "--map"), unique(scale, "--scale")

    from bench import log_import
    from bench.payload import Payload

    folder = output or Path(file.stem)
    entries = log_import.import_log(
        file,
        robot,
        log_import.LogMap(columns, factors, rate),
        folder,
        payload=payload if payload is None or payload_mass is None else Payload(payload, payload_mass),
        **settings,
    )
    for entry in entries:
        click.echo(f"wrote {folder / entry.file} ({entry.use})")
    click.echo(f"next: bench identify {folder}")
