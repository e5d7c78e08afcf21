"""Options that several commands share, the types of their values, and their shell completions."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.basics.errors import BenchError
from bench.basics.files.atomic import why_no_folder, why_unwritable
from bench.cli.last_lines import STANDARD_OUTPUT, answer_on
from bench.dataset.catalogue import built_in_robots, built_in_scenarios, catalogue_folder

if TYPE_CHECKING:
    from bench.dataset.dataset import Dataset
    from bench.identification.problem import Problem
    from bench.page.section_run import CommandRun

_NAMED = "bench.files that are written"
FILTERS = ("position_cutoff", "decimation", "filter_order", "difference_order", "keep_standstill")
"""Fields of `FilterSettings` that are options, in addition to the border."""


def _catalogue() -> Iterable[str]:
    from bench.effects.catalogue import CATALOGUE

    return CATALOGUE


def _completing(
    names: Callable[[], Iterable[str]],
) -> Callable[[click.Context, click.Parameter, str], list[str]]:
    """The completion of a name that a user has begun."""
    return lambda _context, _option, begun: sorted(name for name in names() if name.startswith(begun))


effects = _completing(_catalogue)
robots, scenarios = _completing(built_in_robots), _completing(built_in_scenarios)
sweeps = _completing(lambda: [path.stem for path in catalogue_folder("scenarios").glob("sweeps/*.toml")])

Command = Callable[..., Any]


def path_option(*names: str, **more: Any) -> Callable[[Command], Command]:
    """An option with a path. more: see `click.option`."""
    return click.option(*names, type=click.Path(path_type=Path), **more)


workers_option = click.option(
    "--workers",
    type=click.IntRange(1, 256),
    metavar="N",
    help="Processes on this machine. [default: one a core]",
)
scheduler_option = click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="A Dask scheduler, for example tcp://HOST:8786, instead of local processes.",
)

data_option = path_option(
    "--data",
    metavar="DATASET",
    help="The recordings to show a model file with. [default: those it was identified from]",
)
cad_option = click.option(
    "--cad/--no-cad",
    default=True,
    help="Where the data do not determine masses, stay near those of the MJCF, or near equal bars. [default: cad]",
)


def nearest_option(verb: str) -> Callable[[Command], Command]:
    """The option for physically possible bodies that contradict the data. verb: what the command does with them."""
    words = f"{verb} the nearest physically possible bodies even if the data contradict them."
    return click.option("--nearest", is_flag=True, help=words)


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

effect_file_option = path_option(
    "--effect-file",
    "effect_files",
    multiple=True,
    metavar="FILE",
    help="Python file with your effects. Repeat for each.",
)


def in_existing_folder(context: click.Context, option: click.Parameter, file: Path | None) -> Path | None:
    """Callback that raises BenchError for a file that cannot be written, before any work is done.

    A missing folder is usually a misspelling. Two options with the same file would lose an answer.
    """
    if file is None or file == STANDARD_OUTPUT:
        return file
    if not file.parent.is_dir():
        raise BenchError(f"{option.opts[0]} {file}: there is no folder {file.parent}")
    if (why := why_unwritable(file)) is not None:
        raise BenchError(f"{option.opts[0]} {file}: cannot be written: {why}")
    named: dict[Path, str] = context.meta.setdefault(_NAMED, {})
    other = named.setdefault(file.resolve(), option.opts[0])
    if other != option.opts[0] and (not file.exists() or file.is_file()):
        raise BenchError(f"{option.opts[0]} {file}: {other} names the same file")
    return file


def file_or_folder(context: click.Context, option: click.Parameter, path: Path | None) -> Path | None:
    """Callback for a file that can be written, or a folder in which one can be."""
    check = as_folder if path is not None and path.is_dir() else in_existing_folder
    return check(context, option, path)


def as_folder(_context: click.Context, option: click.Parameter, folder: Path | None) -> Path | None:
    """Callback that raises BenchError for a folder that cannot be written, before any work is done."""
    why = None if folder is None else why_no_folder(folder)
    if why is not None:
        raise BenchError(f"{option.opts[0]} {folder}: {why}")
    return folder


def output_option(help_text: str, **more: Any) -> Callable[[Command], Command]:
    """The option for the output folder of a command. more: see `click.option`."""
    return path_option("-o", "--output", help=help_text, **{"metavar": "DIR", "callback": as_folder, **more})


json_option = path_option(
    "--json",
    "json_file",
    metavar="FILE",
    callback=lambda context, option, file: in_existing_folder(context, option, answer_on(context, file)),
    help="Write the answer as JSON; - for standard output.",
)


rule_option = click.option(
    "--rule",
    multiple=True,
    metavar="NAME=VALUE",
    callback=lambda _context, _option, given: tuple(entry for text in given for entry in text.split(",")),
    help="Threshold or numerical bound in place of the default, as in the JSON answer: prior=12, search.rounds=3. "
    "Repeat for more.",
)


@dataclass(frozen=True)
class Asked:
    """The model that a command requests: its effects, files with the user's effects, and filters by name."""

    effects: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()
    filters: dict[str, Any] = field(default_factory=dict)

    def of(self, dataset: Dataset) -> Problem:
        """The problem of identifying this model from a dataset."""
        from bench.identification.problem import problem_of

        return problem_of(dataset, self.effects, self.filters, effect_files=self.files)

    def run(
        self, command: str, path: Path, options: dict[str, Any] | None = None, output: Path | None = None
    ) -> CommandRun:
        """A command on a path, to be repeated later. options: by default the filters."""
        from bench.page.section_run import CommandRun

        files, into = tuple(map(str, self.files)), "" if output is None else str(output)
        options = self.filters if options is None else options
        return CommandRun(command, str(path), self.effects, files, options, into)


def filter_options(command: Command) -> Command:
    """Add the options of the filters, each of which is chosen from the data's spectra unless it is given.

    The command receives them, with those of `with_option` and `effect_file_option`, as one argument `asked`.
    """

    @wraps(command)
    def packed(
        *arguments: Any,
        effects: tuple[str, ...],
        effect_files: tuple[Path, ...],
        border: str | None,
        **more: Any,
    ) -> Any:
        given = {name: more.pop(name) for name in FILTERS} | {"border": _border(border)}
        filters = {name: value for name, value in given.items() if value is not None}
        return command(*arguments, asked=Asked(effects, effect_files, filters), **more)

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
        packed = option(packed)
    return packed


def _border(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    try:
        start, end = (int(part) for part in text.split(","))
    except ValueError:
        raise BenchError(f"--border {text!r}: give two whole numbers, for example 49,0") from None
    return start, end


def assignment(value: Callable[[str], str | float] = str) -> Callable[[str], tuple[str, str | float]]:
    """The type of `KEY=VALUE`, a pair; the key ends at the first equals sign. value: converts the other side."""

    def split(given: str) -> tuple[str, str | float]:
        key, equals, text = given.partition("=")
        if not (key.strip() and equals and text.strip()):
            raise click.BadParameter(f"{given!r} is not of the form KEY=VALUE")
        try:
            return key.strip(), value(text.strip())
        except ValueError:
            raise click.BadParameter(f"{given!r}: {text.strip()!r} is not a number") from None

    return split


def positive(given: str) -> float:
    """The type of a positive number; the error for a decimal comma suggests a point."""
    try:
        number = float(given)
    except ValueError:
        hint = f": write the decimal point as in {given.replace(',', '.')}" if "," in given else ""
        raise click.BadParameter(f"{given!r} is no number{hint}") from None
    if not 0.0 < number < math.inf:
        raise click.BadParameter(f"{given!r} is not positive")
    return number


def numbers(count: int) -> Callable[[str], tuple[float, ...]]:
    """The type of `count` numbers separated by commas."""

    def split(given: str) -> tuple[float, ...]:
        try:
            values = tuple(float(part) for part in given.split(","))
        except ValueError:
            values = ()
        if len(values) != count or not all(map(math.isfinite, values)):
            raise click.BadParameter(f"{given!r} is not {count} numbers with commas between them")
        return values

    return split


def rate(per: str) -> Callable[[str], tuple[float, str]]:
    """The type of a positive number, alone or with a unit as in 3rad/s: (number, unit). per: s or s2."""
    units = (f"rad/{per}", f"m/{per}")

    def split(given: str) -> tuple[float, str]:
        text = given.replace(" ", "")
        unit = next((unit for unit in units if text.endswith(unit)), "")
        try:
            number = float(text.removesuffix(unit))
        except ValueError:
            number = 0.0
        if not 0.0 < number < math.inf:
            raise click.BadParameter(f"{given!r} is no positive number, alone or in {' or '.join(units)}")
        return number, unit

    return split


def number_or_word(text: str) -> float | str:
    """A number if the text is one, otherwise the text."""
    try:
        return float(text)
    except ValueError:
        return text


def unique(pairs: tuple[tuple[str, Any], ...], option: str) -> dict[str, Any]:
    """Pairs as a mapping. Raises UsageError for a repeated key."""
    for key, count in Counter(key for key, _ in pairs).items():
        if count > 1:
            raise click.UsageError(f"{option}: {key!r} is given twice")
    return dict(pairs)
