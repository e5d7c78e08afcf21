"""Turn a controller's logs into recordings of a dataset."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa

from bench.basics.errors import BenchError, lines_of, refuse
from bench.basics.files.atomic import atomic_path, write_text_atomically
from bench.basics.files.recording_fault import Remedy
from bench.basics.files.table import FileTable
from bench.basics.files.toml_input import read_toml
from bench.basics.progress import SILENT, Progress
from bench.dataset.catalogue import built_in_robots
from bench.dataset.dataset import doubted
from bench.dataset.dataset_toml import DatasetSpec, RecordingEntry, extended_toml
from bench.dataset.joint_facts import JointFacts, joint_facts
from bench.dataset.logs.columns import LogMap, columns_of
from bench.dataset.logs.log_file import AS_FOUND, Reading, read_log
from bench.dataset.logs.segments import UNCUT, Cutting, Segment, cut
from bench.dataset.logs.unit_cures import UnitCures, once_a_row, with_cure
from bench.dataset.names import DATASET_FILE, Check, Use
from bench.dataset.payload import Payload
from bench.dataset.recording import write_table
from bench.dataset.recording_faults import faults_of, listed
from bench.dataset.robot import Robot, load_robot

BEFORE = ".before"  # suffix of a file that is being replaced, until the new one is complete


@dataclass(frozen=True)
class LogRequest:
    """A log to import. payload: name of the payload; name: of the recording's file, by default the log's with the
    suffix .csv. accept: checks that it need not pass.
    """

    file: Path
    log_map: LogMap
    use: Use = "identify"
    payload: str | None = None
    name: str | None = None
    reading: Reading = AS_FOUND
    cutting: Cutting = UNCUT
    accept: tuple[Check, ...] = ()

    @property
    def recording(self) -> str:
        """The recording's file name; the pieces of a log that is cut are named after it."""
        return self.name or f"{self.file.stem}.csv"


@dataclass(frozen=True)
class Imported:
    """The added recordings, and notes by file on what was assumed, cut and dropped."""

    entries: tuple[RecordingEntry, ...]
    notes: tuple[tuple[Path, str], ...]


@dataclass(frozen=True)
class LogFault:
    """A fault of a log, in one line. alike: key that it shares with the same fault of other logs."""

    file: Path
    alike: tuple[str, str, Remedy | None]
    line: str


def _as_fault(file: Path, line: str) -> LogFault:
    return LogFault(file, (line.removeprefix(f"{file}: "), "", None), line)


def _folded(faults: Sequence[LogFault]) -> list[str]:
    """One line for each fault; a fault that several logs share appears once."""
    groups: dict[tuple[str, str, Remedy | None], list[LogFault]] = {}
    for fault in faults:
        groups.setdefault(fault.alike, []).append(fault)
    lines = []
    for first, *others in groups.values():
        names = [path.name for path in dict.fromkeys(fault.file for fault in others) if path != first.file]
        lines.append(f"{first.line}; likewise in {listed(names)}" if names else first.line)
    return lines


def import_log(
    robot: str | Robot,
    request: LogRequest,
    folder: str | Path,
    payload: Payload | None = None,
    *,
    replace: bool = False,
    progress: Progress = SILENT,
) -> Imported:
    """Write one log into a dataset folder; see import_logs."""
    payloads = () if payload is None else (payload,)
    return import_logs(robot, [request], folder, payloads, replace=replace, progress=progress)


def import_logs(
    robot: str | Robot,
    requests: Sequence[LogRequest],
    folder: str | Path,
    payloads: Sequence[Payload] = (),
    *,
    replace: bool = False,
    progress: Progress = SILENT,
) -> Imported:
    """Write logs as recordings into the dataset `folder`, all or none.

    A folder without a dataset.toml becomes a dataset of `robot` (a Robot, a built-in name or a path); otherwise the
    recordings are added to its dataset. `payloads` are defined in it; a request names one of them, or one that the
    dataset already defines. Samples are written as they were logged, after the checks that are made when a dataset is
    read. replace: recordings and payloads of the same name are replaced; the old file is kept until the new one is
    complete.

    Errors: BenchError, and nothing is written, for a file, robot, joint or name that does not exist (the message lists
    those that do), vectors of different length, all faults of the recordings (one line each; a fault shared by several
    logs is reported once, with their names), and a payload far heavier than the robot that is not accepted.
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
            new_parts, wrong, new_notes = _parts(loaded, request, joints, progress)
        except BenchError as error:
            faults += [_as_fault(request.file, line) for line in lines_of(error)]
            continue
        faults += wrong
        parts += new_parts
        entries += [
            RecordingEntry(part.name, part.use, request.payload, request.accept) for part in new_parts
        ]
        notes += [(request.file, note) for note in new_notes]
    refuse([*_folded(faults), *_doubtful(payloads, loaded, requests)])
    names = [part.name for part in parts]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise BenchError(
            f"{folder / twice}: two logs would become this recording: give one of them another name"
        )
    text = extended_toml(folder, _reference(loaded, folder), loaded, entries, payloads, replace=replace)
    if (toml := folder / DATASET_FILE).exists():
        spec = read_toml(toml, DatasetSpec)
        said = [
            *_payload_notes(spec, payloads, names),
            *(_stale_pieces(spec, requests, names) if replace else []),
        ]
        notes += [(toml, note) for note in said]
    progress.phase("writing the recordings", sum(part.columns["time"].size for part in parts))
    _write(folder, text, parts, progress)
    return Imported(tuple(entries), tuple(notes))


def _parts(
    robot: Robot, request: LogRequest, joints: Sequence[JointFacts], progress: Progress
) -> tuple[list[Segment], list[LogFault], tuple[str, ...]]:
    """The recordings of one log, their faults, and notes on what was assumed."""
    file = request.file
    progress.phase(f"reading {file.name}")
    log = read_log(file, request.reading)
    progress.phase(f"checking {file.name}")
    columns = columns_of(file, log, robot, request.log_map)
    parts, cuts = cut(file, columns.values, request.use, request.recording, request.cutting)
    faults = [_as_fault(file, line) for line in columns.faults]
    for part in parts:
        table = FileTable(file, pa.table(dict(part.columns)), log.lines, part.first_row, columns.sources)
        table_faults = faults_of(table, joints, frozenset(request.accept))
        cures = UnitCures(robot, columns, request.log_map.scale, table_faults)
        for fault in once_a_row(table_faults):
            alike = (fault.column, fault.check or "", fault.remedy)
            faults.append(LogFault(file, alike, with_cure(fault, cures)))
    return parts, faults, (*log.notes, *columns.notes, *cuts)


def _doubtful(payloads: Sequence[Payload], robot: Robot, requests: Sequence[LogRequest]) -> list[str]:
    """The question for each payload that is far heavier than the robot, unless a log that carries it accepts it."""
    loads = [(request.payload, request.accept) for request in requests]
    return [
        f"{heavy.words} Then give {heavy.if_grams:g} kg; --accept mass if {heavy.mass:g} kg is meant"
        for heavy in doubted(payloads, loads, robot)
    ]


def _payload_notes(spec: DatasetSpec, payloads: Sequence[Payload], names: Sequence[str]) -> Iterator[str]:
    """Notes on payloads whose mass changes, with the recordings that are not replaced but carry them."""
    for payload in payloads:
        before = spec.payloads[payload.name].mass if payload.name in spec.payloads else payload.mass
        if payload.mass is None or before == payload.mass:
            continue
        carrying = [entry.file for entry in spec.recordings if entry.payload == payload.name]
        others = [file for file in carrying if file not in names]
        was = "had no mass" if before is None else f"was {before:g} kg"
        also = f", in {listed(others)} as well" if others else ""
        yield f"the payload {payload.name} {was} and is {payload.mass:g} kg now{also}"


def _stale_pieces(spec: DatasetSpec, requests: Sequence[LogRequest], names: Sequence[str]) -> Iterator[str]:
    """Notes on recordings that are named like pieces of an imported log but are not among its new ones: an earlier
    import may have cut the log in other places. They are not deleted, since the user may have named a recording so.
    """
    files = [entry.file for entry in spec.recordings]
    for request in requests:
        whole = Path(request.recording)
        piece = re.compile(rf"{re.escape(whole.stem)}(-\d+)?(-validate)?{re.escape(whole.suffix)}")
        stale = [file for file in files if piece.fullmatch(file) and file not in names]
        if stale:
            yield (
                f"{listed(stale)} {'stays as it was' if len(stale) == 1 else 'stay as they were'}: delete pieces of "
                f"{request.file.name} from an earlier import, with their [[recordings]] tables"
            )


def _reference(robot: Robot, folder: Path) -> str:
    """The robot in a dataset.toml in `folder`: a built-in name, else a relative path, else an absolute one."""
    for name, built_in in built_in_robots().items():
        if built_in.resolve() == robot.folder.resolve():
            return name
    try:
        relative = Path(os.path.relpath(robot.folder.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return robot.folder.as_posix()
    return relative if relative.startswith(".") else f"./{relative}"


def _write(folder: Path, text: str, parts: Sequence[Segment], progress: Progress) -> None:
    """Write all files, or none if an error occurs.

    Every recording is complete under a temporary name before any replaced file is moved aside. If the command is killed
    in between, the dataset is unchanged, or it names a missing file that has its old and new recording next to it.
    """
    paths = [folder / part.name for part in parts]
    aside: dict[Path, Path] = {}
    written = False
    try:
        folder.mkdir(parents=True, exist_ok=True)
        toml = folder / DATASET_FILE
        old = toml.read_bytes() if toml.exists() else None
        fresh = [path for path in paths if not path.exists()]
        try:
            with ExitStack() as stack:
                for path, part in zip(paths, parts, strict=True):
                    write_table(stack.enter_context(atomic_path(path)), part.columns, progress)
                for path in paths:
                    if path not in fresh:
                        aside[path] = path.replace(path.with_name(f"{path.name}{BEFORE}"))
                write_text_atomically(toml, text)
            written = True
        finally:
            _settle(toml, old, fresh, aside, written=written)
    except (FileExistsError, NotADirectoryError, PermissionError) as error:
        raise BenchError(f"{folder}: cannot be written: {error.strerror}") from error


def _settle(
    toml: Path, old: bytes | None, fresh: Sequence[Path], aside: Mapping[Path, Path], *, written: bool
) -> None:
    """Delete the replaced files; or, if writing failed, restore them."""
    if written:
        for kept in aside.values():
            kept.unlink(missing_ok=True)
        return
    for path, kept in aside.items():
        kept.replace(path)
    for path in fresh:
        path.unlink(missing_ok=True)
    if old is None:
        toml.unlink(missing_ok=True)
    elif toml.read_bytes() != old:
        write_text_atomically(toml, old.decode("utf-8"))
