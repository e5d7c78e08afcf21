"""Options that several commands share."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from bench.basics.errors import BenchError
from bench.basics.files.atomic import why_no_folder, why_unwritable
from bench.cli.completion import effects
from bench.cli.last_lines import STANDARD_OUTPUT, answer_on

Command = Callable[..., Any]
_NAMED = "bench.files that are written"

dataset_argument = click.argument("dataset", type=click.Path(path_type=Path))

with_option = click.option(
    "--with",
    "effects",
    multiple=True,
    shell_complete=effects,
    metavar="EFFECT[:PLACE][@recording]",
    help="Add an effect to the model, on every actuator or at one place; with @recording it has one value "
    "per fitted recording. Repeat for each.",
)

effect_file_option = click.option(
    "--effect-file",
    "effect_files",
    multiple=True,
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Python file with your effects. Repeat for each.",
)


def in_existing_folder(context: click.Context, option: click.Parameter, file: Path | None) -> Path | None:
    """Refuse a file that cannot be written, before any work is done.

    One in a folder that is not there is misspelt more often than meant. Two options that name one file would lose an
    answer.
    """
    if file is None or file == STANDARD_OUTPUT:
        return file
    if not file.parent.is_dir():
        raise BenchError(f"{option.opts[0]} {file}: there is no folder {file.parent}")
    why = why_unwritable(file)
    if why is not None:
        raise BenchError(f"{option.opts[0]} {file}: cannot be written: {why}")
    named: dict[Path, str] = context.meta.setdefault(_NAMED, {})
    other = named.setdefault(file.resolve(), option.opts[0])
    if other != option.opts[0] and (not file.exists() or file.is_file()):
        raise BenchError(f"{option.opts[0]} {file}: {other} names the same file")
    return file


def file_or_folder(context: click.Context, option: click.Parameter, path: Path | None) -> Path | None:
    """A file that can be written, or a folder in which one can be."""
    check = as_folder if path is not None and path.is_dir() else in_existing_folder
    return check(context, option, path)


def _answer_file(context: click.Context, option: click.Parameter, file: Path | None) -> Path | None:
    """A file in a folder that is there, or "-" for standard output."""
    answer_on(context, file)
    return in_existing_folder(context, option, file)


def as_folder(_context: click.Context, option: click.Parameter, folder: Path | None) -> Path | None:
    """Refuse a folder that is a file, would lie in one, or cannot be written, before any work is done."""
    why = None if folder is None else why_no_folder(folder)
    if why is not None:
        raise BenchError(f"{option.opts[0]} {folder}: {why}")
    return folder


def output_option(help_text: str) -> Callable[[Command], Command]:
    """The folder that a command writes into."""
    return click.option(
        "-o",
        "--output",
        type=click.Path(path_type=Path),
        metavar="DIR",
        callback=as_folder,
        help=help_text,
    )


json_option = click.option(
    "--json",
    "json_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    callback=_answer_file,
    help="Write the answer as JSON; - for standard output.",
)


def _by_commas(_context: click.Context, _option: click.Parameter, given: tuple[str, ...]) -> tuple[str, ...]:
    """Each of them, however many stand in one."""
    return tuple(one for text in given for one in text.split(","))


rule_option = click.option(
    "--rule",
    multiple=True,
    metavar="NAME=VALUE",
    callback=_by_commas,
    help="Threshold or numerical bound in place of the default, as in the JSON answer: prior=12, search.rounds=3. "
    "Repeat for more.",
)


def filter_options(command: Command) -> Command:
    """The filters: each is chosen from the data's spectra unless it is given."""
    for option in reversed(
        (
            click.option("--position-cutoff", type=float, metavar="HZ", help="Low-pass on positions."),
            click.option(
                "--decimation",
                type=int,
                metavar="N",
                help="Keep one sample in N after the low-pass of the fit.",
            ),
            click.option("--filter-order", type=int, metavar="N", help="Order of the low-pass on positions."),
            click.option(
                "--difference-order",
                type=int,
                metavar="N",
                help="Order of the central differences: 2, 4, 6, 8.",
            ),
            click.option(
                "--keep-standstill",
                is_flag=True,
                default=None,
                help="Also fit and judge rows in which a joint stands still.",
            ),
            click.option(
                "--border", metavar="START,END", help="Samples dropped at both ends, after differentiation."
            ),
        )
    ):
        command = option(command)
    return command


def given_filters(
    position_cutoff: float | None,
    decimation: int | None,
    filter_order: int | None,
    difference_order: int | None,
    keep_standstill: bool | None,
    border: str | None,
) -> dict[str, Any]:
    """The filter settings that were given, by the names of `FilterSettings`."""
    given: dict[str, Any] = {
        "position_cutoff": position_cutoff,
        "decimation": decimation,
        "filter_order": filter_order,
        "difference_order": difference_order,
        "keep_standstill": keep_standstill,
    }
    if border is not None:
        try:
            start, end = (int(part) for part in border.split(","))
        except ValueError:
            raise BenchError(f"--border {border!r}: give two whole numbers, for example 49,0") from None
        given["border"] = (start, end)
    return {name: value for name, value in given.items() if value is not None}
