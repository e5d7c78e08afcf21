"""Many logs in one call: a TOML file maps their columns and names the payload of each.

robot = "five_bar"                   # a built-in name, or a path relative to this file
rate, skip_rows, header, split_gaps, shortest, topic   # as the options of the same names, for all logs

[columns]
time = "t"
"position.left" = "q1"

[scale]
position = "deg"

[payloads.disc]                      # as in dataset.toml
mass = 0.5

[[logs]]
files = "held_*.csv"                 # a file or a pattern relative to this file, or several
payload = "disc"
"""

from pathlib import Path
from typing import Annotated

from pydantic import Field, field_validator

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import UserTable, read_toml
from bench.basics.progress import SILENT, Progress
from bench.dataset.dataset_toml import Number, PayloadSpec, payload_of
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.importing import Imported, LogRequest, import_logs
from bench.dataset.logs.log_file import Reading
from bench.dataset.logs.segments import SHORTEST, Cutting
from bench.dataset.names import Check, Use
from bench.dataset.robot import load_robot

Text = Annotated[str, Field(min_length=1)]


class LogsTable(UserTable):
    """[[logs]]: files that were recorded in the same way. name: of the recording's file, only for a single log."""

    files: tuple[Text, ...]
    use: Use = "identify"
    payload: str | None = None
    name: Text | None = None
    validate_fraction: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    accept: tuple[Check, ...] = ()

    @field_validator("files", mode="before")
    @classmethod
    def _several(cls, files: object) -> object:
        return (files,) if isinstance(files, str) else files


class MappingTable(UserTable):
    """The keys of a mapping file."""

    robot: Text
    columns: dict[str, Text] = Field(default_factory=dict)
    scale: dict[str, Number | str] = Field(default_factory=dict)
    rate: Annotated[Number, Field(gt=0.0)] | None = None
    skip_rows: Annotated[int, Field(ge=0)] = 0
    header: bool | None = None
    topic: Text | None = None
    split_gaps: bool = False
    shortest: Annotated[Number, Field(gt=0.0)] = SHORTEST
    payloads: dict[str, PayloadSpec] = Field(default_factory=dict)
    logs: Annotated[tuple[LogsTable, ...], Field(min_length=1)]


def import_mapping(
    path: Path, folder: Path, *, replace: bool = False, progress: Progress = SILENT
) -> Imported:
    """Import all logs that the mapping file `path` names into the dataset `folder`, all or none; see import_logs.

    Raises BenchError: one line for a fault of the mapping, or a line for each fault of the logs.
    """
    table = read_toml(path, MappingTable)
    robot = load_robot(table.robot, relative_to=path.parent)
    used = {log.payload for log in table.logs}
    payloads = [payload_of(path, name, spec) for name, spec in table.payloads.items()]
    if unused := [payload.name for payload in payloads if payload.name not in used]:
        raise BenchError(f"{path}: payloads.{unused[0]}: no log carries it")
    requests = [
        LogRequest(
            file,
            LogMap(table.columns, table.scale, table.rate),
            log.use,
            log.payload,
            log.name,
            Reading(table.skip_rows, table.header, table.topic),
            Cutting(log.validate_fraction, table.shortest if table.split_gaps else None),
            log.accept,
        )
        for i, log in enumerate(table.logs)
        for file in _files(path, i, log)
    ]
    return import_logs(robot, requests, folder, payloads, replace=replace, progress=progress)


def _files(path: Path, index: int, table: LogsTable) -> list[Path]:
    """The files of [[logs]]. Raises BenchError for a pattern without files, or a name for several."""
    files: list[Path] = []
    for pattern in table.files:
        whole = Path(pattern)
        base = Path(whole.anchor) if whole.is_absolute() else path.parent
        matching = sorted(base.glob(str(whole.relative_to(whole.anchor))))
        if not matching:
            raise BenchError(f"{path}: logs[{index}].files: no file {pattern!r} in {path.parent.resolve()}")
        files += matching
    if table.name is not None and len(files) > 1:
        raise BenchError(
            f"{path}: logs[{index}].name: {table.name!r} cannot be the name of {len(files)} logs"
        )
    return files
