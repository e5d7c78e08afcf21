"""One log is imported, with the parts of a request as arguments."""

from pathlib import Path
from typing import Any

from bench.dataset.dataset_toml import RecordingEntry
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.importing import Imported, LogRequest, import_log
from bench.dataset.logs.segments import Cutting
from bench.dataset.payload import Payload


def told(
    file: Path,
    robot: str,
    log_map: LogMap,
    folder: Path,
    use: str = "identify",
    payload: Payload | str | None = None,
    validate_fraction: float = 0.0,
    shortest: float | None = None,
    **more: Any,
) -> Imported:
    """What `import_log` answers; a payload to define, or its name."""
    name = payload.name if isinstance(payload, Payload) else payload
    cutting = Cutting(validate_fraction, shortest)
    request = LogRequest(file, log_map, use, payload=name, cutting=cutting, **more)
    return import_log(robot, request, folder, payload if isinstance(payload, Payload) else None)


def imported(*args: Any, **more: Any) -> list[RecordingEntry]:
    """The recordings that were added."""
    return list(told(*args, **more).entries)
