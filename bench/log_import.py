"""Turn a controller's log into a recording of a dataset."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from bench.catalogue import built_in_robots
from bench.dataset_toml import DATASET_FILE, RecordingEntry, extended_toml
from bench.errors import BenchError, meant
from bench.files import write_text_atomically
from bench.joint_facts import joint_facts
from bench.log_file import Log, read_log
from bench.payload import Payload
from bench.recording import Use, write_table
from bench.recording_checks import Check
from bench.recording_file import recording_from_table
from bench.robot import Robot, load_robot
from bench.table_file import SUFFIXES, Table

Array = npt.NDArray[np.float64]


UNITS: Mapping[str, float] = {
    "deg": np.pi / 180.0,
    "turn": 2.0 * np.pi,
    "mrad": 1e-3,
    "mm": 1e-3,
    "um": 1e-6,
    "ms": 1e-3,
    "us": 1e-6,
    "mA": 1e-3,
    "mV": 1e-3,
}
"""Units that a log may be in, as factors that turn them into SI."""


@dataclass(frozen=True)
class LogMap:
    """Which names of a log become which columns of a recording.

    columns  column -> name in the log; columns are `time`, `position.JOINT`, `current.JOINT`, and any other
             name for a column to keep for plots. A column that the log itself calls so needs no entry.
    scale    column -> factor that turns the log's unit into SI, such as 1e-3 for millimetres, or the unit's name
             (see UNITS); `position` and `current` stand for those of all joints
    rate     Hz, for a log without a time column; its time then starts at zero
    """

    columns: Mapping[str, str]
    scale: Mapping[str, float | str] | None = None
    rate: float | None = None


def import_log(
    file: str | Path,
    robot: str,
    log_map: LogMap,
    folder: str | Path,
    use: Use = "identify",
    payload: Payload | str | None = None,
    name: str | None = None,
    validate_fraction: float = 0.0,
    accept: Sequence[Check] = (),
) -> list[RecordingEntry]:
    """Write the log `file` as a recording into the dataset `folder`; the recordings that were added.

    A folder without a dataset.toml becomes a dataset of `robot` (a built-in name or a path); otherwise the
    recording is added to it. `payload` is a name that the dataset defines, or a payload to define. `name` is
    the recording's file name, by default that of the log with the suffix .csv. With `validate_fraction` the
    last part of the log is kept apart, for validation only, as NAME-validate. Samples are written as they
    were logged, after the checks that reading a dataset makes, `accept` aside.

    Errors: BenchError in one line, and nothing is written: a file, robot, joint or name that does not exist
    (with what there is), vectors of different length, everything that is wrong with a recording.
    """
    file, folder = Path(file), Path(folder)
    loaded = load_robot(robot)
    reference = _reference(loaded, folder)
    log_map = replace(log_map, scale=_factors(file, log_map.scale or {}, loaded))
    log = read_log(file)
    sources = _sources(file, log, loaded, log_map)
    columns = _columns(file, log, sources, log_map)
    parts = _split(file, columns, use, name or f"{file.stem}.csv", validate_fraction)
    label = payload.name if isinstance(payload, Payload) else payload
    entries = [RecordingEntry(part.name, part.use, label, tuple(accept)) for part in parts]
    text = extended_toml(
        folder, reference, loaded, entries, payload if isinstance(payload, Payload) else None
    )
    joints = joint_facts(loaded)
    for part in parts:
        try:
            table = Table(file, part.table, log.lines, part.first_row, sources)
            recording_from_table(table, part.name, part.use, label, joints, accept)
        except BenchError as error:
            raise BenchError(_with_cure(str(error))) from error
    _write(folder, text, parts)
    return entries


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


def _factors(file: Path, scale: Mapping[str, float | str], robot: Robot) -> dict[str, float]:
    """Factors by column: units by their names, and those of all joints one by one."""
    factors: dict[str, float] = {}
    for target, given in scale.items():
        if isinstance(given, str) and given not in UNITS:
            raise BenchError(f"{file}: the scale of {target}: no unit {given!r}; {meant(given, UNITS)}")
        factor = UNITS[given] if isinstance(given, str) else given
        all_joints = target in ("position", "current")
        for column in [f"{target}.{joint}" for joint in robot.joints] if all_joints else [target]:
            factors[column] = factor
    return factors


CURES = {
    "looks like degrees": "--scale position=deg",
    "looks like millimetres": "--scale position=mm",
    "looks like milliseconds": "--scale time=ms",
    "looks like microseconds": "--scale time=us",
    "looks like nanoseconds": "--scale time=1e-9",
    "looks like thousandths": "--scale current=mA",
}
"""What to add to the command, by what a check says."""


def _with_cure(message: str) -> str:
    """A check's message as it helps in an import: an option instead of a key of dataset.toml."""
    found = re.sub(r' \(accept = \["(\w+)"\] .*\)$', r" (--accept \1 if that is meant)", message)
    cure = next((option for said, option in CURES.items() if said in message), None)
    return found if cure is None else f"{found}; add {cure}"


@dataclass(frozen=True, eq=False)
class _Part:
    name: str
    use: Use
    columns: Mapping[str, Array]
    first_row: int = 0

    @property
    def table(self) -> pa.Table:
        return pa.table({name: pa.array(values) for name, values in self.columns.items()})


def _sources(file: Path, log: Log, robot: Robot, log_map: LogMap) -> dict[str, str]:
    """Column -> its name in the log, for all that the recording gets."""
    needed = [f"{kind}.{joint}" for kind in ("position", "current") for joint in robot.joints]
    if log_map.rate is None:
        needed.insert(0, "time")
    elif "time" in log_map.columns:
        raise BenchError(f"{file}: give a rate or map time, not both")
    elif not (np.isfinite(log_map.rate) and log_map.rate > 0.0):
        raise BenchError(f"{file}: the rate must be positive, not {log_map.rate:g} Hz")
    _check_targets(file, log_map, needed, robot)
    there = [*log.vectors, *log.texts]
    sources = {target: target for target in needed if target in there} | dict(log_map.columns)
    missing = [target for target in needed if target not in sources]
    if missing:
        raise BenchError(f"{file}: nothing is mapped to {', '.join(missing)} (the log has {_inventory(log)})")
    for target, source in sources.items():
        if source not in there:
            raise BenchError(f"{file}: there is no {source!r} for {target} (the log has {_inventory(log)})")
    return sources


def _columns(file: Path, log: Log, sources: Mapping[str, str], log_map: LogMap) -> dict[str, Array]:
    """The recording's columns in SI, `time` first."""
    scale: Mapping[str, Any] = log_map.scale or {}
    columns = {target: log.numbers(source) * scale.get(target, 1.0) for target, source in sources.items()}
    if log_map.rate is not None:
        first = next(target for target in sources if target.startswith("position."))
        columns = {"time": np.arange(columns[first].size) / log_map.rate} | columns
    count = columns["time"].size
    for target, values in columns.items():
        if values.size != count:
            source = sources[target]
            raise BenchError(f"{file}: {source!r} for {target} has {values.size} samples, time has {count}")
    return {name: columns[name] for name in sorted(columns, key=lambda name: name != "time")}


def _check_targets(file: Path, log_map: LogMap, needed: Sequence[str], robot: Robot) -> None:
    for target in (*log_map.columns, *(log_map.scale or {})):
        if target not in needed and target.startswith(("position.", "current.")):
            joints = ", ".join(robot.joints)
            raise BenchError(f"{file}: {target!r}: the robot {robot.name!r} drives {joints}")
    scale: Mapping[str, Any] = log_map.scale or {}
    for target, factor in scale.items():
        if target not in needed and target not in log_map.columns:
            raise BenchError(f"{file}: {target!r} has a scale but nothing is mapped to it")
        if not np.isfinite(factor) or factor == 0.0:
            raise BenchError(f"{file}: the scale of {target} must not be {factor:g}")


def _inventory(log: Log, most: int = 30) -> str:
    names = [f"{name} ({values.size})" for name, values in log.vectors.items()]
    names += [f"{name} (with text)" for name in log.texts]
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def _split(file: Path, columns: Mapping[str, Array], use: Use, name: str, fraction: float) -> list[_Part]:
    path = Path(name)
    if path.suffix.lower() not in SUFFIXES or path.name != name:
        raise BenchError(f"{name}: a recording's name is a file name that ends in {' or '.join(SUFFIXES)}")
    if fraction == 0.0:
        return [_Part(name, use, columns)]
    if not 0.0 < fraction < 1.0 or use != "identify":
        raise BenchError(f"{file}: a part of 0 to 1 of a log to identify can be kept apart, not {fraction:g}")
    count = columns["time"].size
    first = round(count * (1.0 - fraction))
    return [
        _Part(name, "identify", {key: values[:first] for key, values in columns.items()}),
        _Part(
            f"{path.stem}-validate{path.suffix}",
            "validate",
            {key: values[first:] for key, values in columns.items()},
            first,
        ),
    ]


def _write(folder: Path, text: str, parts: Sequence[_Part]) -> None:
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
