"""`bench import`: a controller's log becomes a recording of a dataset."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.cli.last_lines import next_line, say, wrote
from bench.cli.options import assignment, number_or_word, numbers, path_option, positive, robots, unique
from bench.cli.progress import quiet_option, shown_progress

if TYPE_CHECKING:
    from bench.dataset.logs.importing import LogRequest
    from bench.dataset.payload import Payload

CHECKS = ("units", "limits", "constant", "spikes", "frozen", "saturated", "mass")

BESIDE_MAPPING = ("mapping_file", "output", "replace", "quiet")


@click.command("import")
@click.argument("files", metavar="[FILE]", type=click.Path(path_type=Path), nargs=-1)
@click.option("--robot", shell_complete=robots, help="Built-in name, or path of a robot folder.")
@path_option(
    "--mapping",
    "mapping_file",
    metavar="MAP.toml",
    help="Import many logs in one call: robot, columns, scales, files and payloads from this file.",
)
@click.option(
    "--map",
    "mapping",
    type=assignment(),
    multiple=True,
    metavar="COLUMN=NAME",
    help="The log's NAME becomes COLUMN: time, position.JOINT, current.JOINT, or one to keep for plots."
    " Repeat for each; not needed if the log already uses the name. If no line names them, columns"
    " are called 1, 2, 3 ...",
)
@click.option(
    "--scale",
    type=assignment(number_or_word),
    multiple=True,
    metavar="COLUMN=FACTOR",
    help="Multiply COLUMN to get SI units, or name its unit: time=ms, position.axis=1e-3, position=deg or"
    " current=mA for all joints. It overrides units that the log states; -1 changes the sign and keeps the unit.",
)
@click.option("--skip-rows", type=click.IntRange(0), default=0, metavar="N", help="Skip N lines at the top.")
@click.option("--no-header", is_flag=True, help="No line of the log names its columns.")
@click.option("--topic", metavar="NAME", help="The topic of a ROS bag, if several have joint states.")
@click.option("--rate", type=float, metavar="HZ", help="Sampling rate of a log without a time column.")
@path_option(
    "-o",
    "--output",
    metavar="DATASET",
    help="Dataset folder to make or to add to. [default: the log's name without its suffix,"
    " or the folder's with _dataset]",
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
    help="Reserve the last PART (0 to 1) of the log for validation.",
)
@click.option(
    "--split-gaps",
    is_flag=True,
    help="Split the log into several recordings where samples are missing or time runs backwards.",
)
@click.option(
    "--shortest",
    type=click.FloatRange(0, min_open=True),
    metavar="SECONDS",
    help="Drop shorter pieces between cuts. [default: 2]",
)
@click.option("--payload", metavar="NAME", help="The payload on the tool.")
@click.option(
    "--payload-mass",
    type=positive,
    metavar="KG",
    help="Define the payload by its weighed mass; unknown values are estimated.",
)
@click.option(
    "--payload-center",
    type=numbers(3),
    metavar="X,Y,Z",
    help="Its centre of mass in the tool frame, if known, m.",
)
@click.option(
    "--payload-inertia",
    type=numbers(6),
    metavar="XX,YY,ZZ,XY,XZ,YZ",
    help="Its inertia about its centre of mass, if known, kg*m^2.",
)
@click.option(
    "--accept",
    type=click.Choice(CHECKS),
    multiple=True,
    help="Accept a recording that fails this check; mass: a payload far heavier than the robot.",
)
@click.option(
    "--replace",
    is_flag=True,
    help="Replace the recording of the same name, and the numbers of an existing payload. The old file is kept"
    " until the new one is complete.",
)
@quiet_option
@click.pass_context
def import_log(
    context: click.Context,
    /,
    files: tuple[Path, ...],
    mapping_file: Path | None,
    output: Path | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn a controller's logs into a dataset.

    \b
    bench import log.mat --robot emps \\
        --map time=t --map position.axis=qm --map current.axis=vir

    FILE is .mat, .npz, .parquet, a text (.csv, .tsv, .txt, .dat, .log), or a ROS bag with joint states (.mcap,
    .db3, .bag, or the folder of a ROS 2 bag), for which 'parabench[ros]' must be installed.
    """
    from bench.dataset.logs.importing import import_log
    from bench.dataset.logs.mapping_file import import_mapping

    if mapping_file is not None:
        _refuse_with_mapping(context)
        folder = output or Path(mapping_file.stem)
        with shown_progress(quiet) as progress:
            imported = import_mapping(mapping_file, folder, replace=options["replace"], progress=progress)
    else:
        if len(files) > 1:
            raise click.UsageError(
                f"got {len(files)} logs; --mapping MAP.toml imports several in one call, with robot, columns and"
                " [[logs]] files = [...] in that file"
            )
        if not files or options["robot"] is None:
            raise click.UsageError("give a log and --robot, or --mapping MAP.toml")
        (file,) = files
        folder = output or Path(f"{file.name}_dataset" if file.is_dir() else file.stem)
        request, payload = _request(file, options), _payload(options)
        with shown_progress(quiet) as progress:
            imported = import_log(
                options["robot"], request, folder, payload, replace=options["replace"], progress=progress
            )
    for line in _said_once(imported.notes):
        click.echo(line)
    for entry in imported.entries:
        say([wrote(folder / entry.file, entry.use)])
    say([next_line(["identify", folder])])


def _said_once(notes: Sequence[tuple[Path, str]]) -> list[str]:
    """A line for each note; a note that several logs share names the first log and the number of the others."""
    files: dict[str, list[Path]] = {}
    for path, note in notes:
        files.setdefault(note, []).append(path)
    return [
        f"{paths[0]}{f' and {len(paths) - 1} more' if len(paths) > 1 else ''}: {note}"
        for note, paths in files.items()
    ]


def _refuse_with_mapping(context: click.Context) -> None:
    """Raise UsageError for an option that a mapping file contains itself."""
    for option in context.command.params:
        given = context.get_parameter_source(option.name or "") is not click.core.ParameterSource.DEFAULT
        if given and option.name not in BESIDE_MAPPING:
            name = option.opts[0] if option.opts[0].startswith("-") else "FILE"
            raise click.UsageError(
                f"{name} belongs in the mapping file, not on the command line with --mapping"
            )


def _payload(options: Mapping[str, Any]) -> "Payload | None":
    """The payload to define, if its mass is given."""
    import numpy as np

    from bench.basics.errors import BenchError
    from bench.dataset.payload import Payload, payload_fault

    name, mass = options["payload"], options["payload_mass"]
    center, inertia = (
        None if options[key] is None else np.array(options[key])
        for key in ("payload_center", "payload_inertia")
    )
    if mass is None:
        if center is not None or inertia is not None:
            raise click.UsageError("--payload-center and --payload-inertia need --payload-mass KG")
        return None
    if name is None:
        raise click.UsageError("--payload-mass needs --payload NAME")
    payload = Payload(name, mass, center, inertia)
    if (fault := payload_fault(payload)) is not None:
        raise BenchError(f"payload {name}: {fault[0]}: {fault[1]}")
    return payload


def _request(file: Path, options: Mapping[str, Any]) -> "LogRequest":
    """The request for one log."""
    from bench.dataset.logs.columns import LogMap
    from bench.dataset.logs.importing import LogRequest
    from bench.dataset.logs.log_file import Reading
    from bench.dataset.logs.segments import SHORTEST, Cutting

    if options["shortest"] is not None and not options["split_gaps"]:
        raise click.UsageError("--shortest needs --split-gaps")
    shortest = (options["shortest"] or SHORTEST) if options["split_gaps"] else None
    columns, factors = unique(options["mapping"], "--map"), unique(options["scale"], "--scale")
    return LogRequest(
        file,
        LogMap(columns, factors, options["rate"]),
        options["use"],
        options["payload"],
        options["name"],
        Reading(options["skip_rows"], False if options["no_header"] else None, options["topic"]),
        Cutting(options["validate_fraction"], shortest),
        options["accept"],
    )
