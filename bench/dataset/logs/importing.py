"""Turn a controller's logs into recordings of a dataset."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.basics.errors import BenchError, lines_of, refuse
from bench.basics.files.atomic import write_text_atomically
from bench.basics.files.recording_fault import RecordingFaultError, Remedy
from bench.basics.files.table import FileTable
from bench.dataset.catalogue import built_in_robots
from bench.dataset.dataset_toml import DATASET_FILE, RecordingEntry, extended_toml
from bench.dataset.joint_facts import JointFacts, joint_facts
from bench.dataset.logs.columns import LogMap, columns_of
from bench.dataset.logs.log_file import AS_FOUND, Reading, read_log
from bench.dataset.logs.segments import UNCUT, Cutting, Segment, cut
from bench.dataset.logs.units import UNITS
from bench.dataset.payload import Payload
from bench.dataset.recording import Use, write_table
from bench.dataset.recording_checks import Check
from bench.dataset.recording_faults import faults_of, listed
from bench.dataset.robot import Robot, load_robot

HEAVY = 2.0  # times the mass of the robot's bodies: hardly a robot carries that
LIGHT = 5.0  # kg: lighter payloads are nothing to ask about, whatever an MJCF says of its bodies


@dataclass(frozen=True)
class LogRequest:
    """A log to import. payload: its name; name: of the recording's file, by default the log's with the suffix .csv.

    accept: checks that it need not pass.
    """

    file: Path
    log_map: LogMap
    use: Use = "identify"
    payload: str | None = None
    name: str | None = None
    reading: Reading = AS_FOUND
    cutting: Cutting = UNCUT
    accept: tuple[Check, ...] = ()


@dataclass(frozen=True)
class Imported:
    """The recordings that were added, and what was assumed, cut and dropped: words by file."""

    entries: tuple[RecordingEntry, ...]
    notes: tuple[tuple[Path, str], ...]


@dataclass(frozen=True)
class LogFault:
    """What is wrong with a log, in a line. alike: what it has in common with the same fault of other logs."""

    file: Path
    alike: tuple[str, str, Remedy | None]
    line: str


def _as_fault(file: Path, line: str) -> LogFault:
    return LogFault(file, (line.removeprefix(f"{file}: "), "", None), line)


def _folded(faults: Sequence[LogFault]) -> list[str]:
    """A line each; what several logs have in common stands once."""
    groups: dict[tuple[str, str, Remedy | None], list[LogFault]] = {}
    for fault in faults:
        groups.setdefault(fault.alike, []).append(fault)
    told = []
    for first, *others in groups.values():
        names = [path.name for path in dict.fromkeys(fault.file for fault in others) if path != first.file]
        told.append(f"{first.line}; likewise in {listed(names)}" if names else first.line)
    return told


def import_log(
    robot: str | Robot, request: LogRequest, folder: str | Path, payload: Payload | None = None
) -> Imported:
    """Write one log into a dataset folder; see import_logs."""
    return import_logs(robot, [request], folder, () if payload is None else (payload,))


def import_logs(
    robot: str | Robot, requests: Sequence[LogRequest], folder: str | Path, payloads: Sequence[Payload] = ()
) -> Imported:
    """Write logs as recordings into the dataset `folder`, all or none.

    A folder without a dataset.toml becomes a dataset of `robot` (or its built-in name or path); otherwise the
    recordings are added to it. `payloads` are defined in it; a request names one of them, or one that the dataset has.
    Samples are written as they were logged, after the checks that reading a dataset makes.

    Errors: BenchError, and nothing is written: a file, robot, joint or name that does not exist (with what there is),
    vectors of different length, everything that is wrong with the recordings, a line each; of what several logs
    have in common, the first is told and the others named.
    """
    folder = Path(folder)
    loaded = robot if isinstance(robot, Robot) else load_robot(robot)
    joints = joint_facts(loaded)
    parts: list[Segment] = []
    entries: list[RecordingEntry] = []
    notes: list[tuple[Path, str]] = []
    faults: list[LogFault] = []
    for request in requests:
        try:
            found, wrong, told = _parts(loaded, request, joints)
        except BenchError as error:
            faults += [_as_fault(request.file, line) for line in lines_of(error)]
            continue
        faults += wrong
        parts += found
        entries += [RecordingEntry(part.name, part.use, request.payload, request.accept) for part in found]
        notes += [(request.file, note) for note in told]
    refuse(_folded(faults))
    names = [part.name for part in parts]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise BenchError(
            f"{folder / twice}: two logs would become this recording: name one of them otherwise"
        )
    text = extended_toml(folder, _reference(loaded, folder), loaded, entries, payloads)
    _write(folder, text, parts)
    notes += [(folder / DATASET_FILE, said) for payload in payloads if (said := _heavy(payload, loaded))]
    return Imported(tuple(entries), tuple(notes))


def _parts(
    robot: Robot, request: LogRequest, joints: Sequence[JointFacts]
) -> tuple[list[Segment], list[LogFault], tuple[str, ...]]:
    """The recordings of one log, what is wrong with them, and what was assumed."""
    file = request.file
    log = read_log(file, request.reading)
    columns = columns_of(file, log, robot, request.log_map)
    name = request.name or f"{file.stem}.csv"
    parts, cuts = cut(file, columns.values, request.use, name, request.cutting)
    faults = [_as_fault(file, line) for line in columns.faults]
    for part in parts:
        table = FileTable(file, part.table, log.lines, part.first_row, columns.sources)
        found = faults_of(table, joints, frozenset(request.accept))
        for fault in found:
            alike = (fault.column, fault.check or "", fault.remedy)
            faults.append(LogFault(file, alike, _with_cure(fault, request.log_map.scale)))
    return parts, faults, (*log.notes, *columns.notes, *cuts)


def _heavy(payload: Payload, robot: Robot) -> str | None:
    """What is said of a payload far heavier than the robot's own bodies, as its MJCF has them."""
    own = float(robot.mjcf_model().body_mass.sum())
    if payload.mass is None or payload.mass <= max(HEAVY * own, LIGHT):
        return None
    return (
        f"the payload {payload.name} of {payload.mass:g} kg is far heavier than the robot ({own:.3g} kg in its MJCF): "
        f"grams? then mass = {payload.mass / 1e3:g}"
    )


def _reference(robot: Robot, folder: Path) -> str:
    """How a dataset in `folder` names the robot: a built-in name, else a path relative to it where there is one."""
    for name, built_in in built_in_robots().items():
        if built_in.resolve() == robot.folder.resolve():
            return name
    try:
        relative = Path(os.path.relpath(robot.folder.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return robot.folder.as_posix()
    return relative if relative.startswith(".") else f"./{relative}"


LIKE: Mapping[Remedy, tuple[str, str]] = {
    Remedy.FROM_DEGREES: ("position", "deg"),
    Remedy.FROM_MILLIMETRES: ("position", "mm"),
    Remedy.FROM_MILLISECONDS: ("time", "ms"),
    Remedy.FROM_MICROSECONDS: ("time", "us"),
    Remedy.FROM_NANOSECONDS: ("time", "ns"),
    Remedy.FROM_THOUSANDTHS: ("current", "mA"),
}
"""Which columns a log has in which unit, where a check takes them for that."""

CUTS: Mapping[Remedy, str] = {
    Remedy.CUT_AT_GAPS: "cut the log there",
    Remedy.LEAVE_ROWS_OUT: "leave such rows out and cut the log there",
}
"""What --split-gaps does about a fault."""


def _with_cure(fault: RecordingFaultError, scale: Mapping[str, float | str]) -> str:
    """A fault's message as it helps in an import: an option instead of a key of dataset.toml. scale: as it is given."""
    if fault.remedy is Remedy.REMOVE_ROWS:
        return f"{fault.said}{fault.advice}"
    said = fault.said if fault.check is None else f"{fault.said} (--accept {fault.check} if that is meant)"
    if fault.remedy is not None and fault.remedy in CUTS:
        return f"{said}; add --split-gaps to {CUTS[fault.remedy]}"
    if fault.remedy is None or fault.remedy not in LIKE:
        return said
    target, unit = LIKE[fault.remedy]
    if target not in scale:
        return f"{said}; add --scale {target}={unit}"
    given = scale[target]
    return f"{said}; give {_scaled(target, given, unit)} in place of --scale {target}={_number(given)}"


def _scaled(target: str, given: float | str, unit: str) -> str:
    """The scale that a column needs which, scaled as given, looks as if it were still in a unit."""
    factor = (UNITS[given].factor if isinstance(given, str) else given) * UNITS[unit].factor
    return f"--scale {target}={factor:.12g}"


def _number(given: float | str) -> str:
    return given if isinstance(given, str) else f"{given:.12g}"


def _write(folder: Path, text: str, parts: Sequence[Segment]) -> None:
    """All files, or none when something goes wrong on the way."""
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for part in parts:
            written.append(folder / part.name)
            write_table(folder / part.name, part.columns)
        write_text_atomically(folder / DATASET_FILE, text)
        written.clear()
    except (FileExistsError, NotADirectoryError, PermissionError) as error:
        raise BenchError(f"{folder}: cannot be written: {error.strerror}") from error
    finally:
        for path in written:
            path.unlink(missing_ok=True)
