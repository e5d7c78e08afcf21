"""A recording: the log of a robot's controller during one movement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.basics.progress import SILENT, Progress
from bench.dataset.names import Use

Array = npt.NDArray[np.float64]
WRITTEN = 50_000  # rows of a CSV that are written at once


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """Joint positions and current references on a uniform time grid.

    - `name`: the file name as dataset.toml gives it
    - `use`: "identify": fitted; "validate": only compared
    - `payload`: name of the payload on the tool, or None
    - `time`: (N,) s, uniform
    - `position`: (N, n) rad or m, in the order of the robot's actuators
    - `current`: (N, n) current reference in the drive's unit (A or V), same order
    - `extra`: other columns of numbers, each (N,), for plots; positions of the joints of redundant motors;
      logged velocities
    - `part_of`: name of the log that this is a part of; empty if it is a whole log
    - `started`: start of that log, s; None: at the first sample
    - `held`: share of the log's rows that repeated the previous one and were dropped
    - `redundant`: (N, r) current references of the robot's redundant motors, in their order; None if it has none
    """

    name: str
    use: Use
    payload: str | None
    time: Array
    position: Array
    current: Array
    extra: Mapping[str, Array] = field(default_factory=dict)
    part_of: str = ""
    started: float | None = None
    redundant: Array | None = None
    held: float = 0.0

    def __repr__(self) -> str:
        carried = f", payload {self.payload}" if self.payload is not None else ""
        duration = float(self.time[-1] - self.time[0])
        return f"<recording {self.name}: {len(self.time)} samples, {duration:.3g} s, {self.use}{carried}>"

    @property
    def log(self) -> str:
        """Name of the log to which it belongs; parts of one log share quantities that belong to the log."""
        return self.part_of or self.name

    @property
    def began(self) -> float:
        """Start of the log, s: the time origin of warming and wear."""
        return float(self.time[0]) if self.started is None else self.started

    @property
    def redundant_current(self) -> Array:
        """Current references of the redundant motors (N, r), with r = 0 where the robot has none."""
        return np.zeros((len(self.time), 0)) if self.redundant is None else self.redundant

    @property
    def rate(self) -> float:
        """Samples per second, Hz, to twelve digits."""
        return float(f"{(self.time.size - 1) / (self.time[-1] - self.time[0]):.12g}")

    def part(self, where: slice) -> Recording:
        """The samples `where`, as a recording of the same name."""
        return replace(
            self,
            time=self.time[where],
            position=self.position[where],
            current=self.current[where],
            extra={name: values[where] for name, values in self.extra.items()},
            redundant=None if self.redundant is None else self.redundant[where],
        )


def position_column(joint: str) -> str:
    """The column of a recording with the position of a joint, rad or m."""
    return f"position.{joint}"


def velocity_column(joint: str) -> str:
    """The optional column of a recording with the logged velocity of a joint, rad/s or m/s."""
    return f"velocity.{joint}"


def write_recording(
    path: str | Path,
    time: npt.ArrayLike,
    position: npt.ArrayLike,
    current: npt.ArrayLike,
    joints: Sequence[str],
    extra: Mapping[str, npt.ArrayLike] | None = None,
) -> None:
    """Write a recording as CSV or Parquet, by the suffix of `path`, whole or not at all.

    time (N,) s; position (N, n) rad or m; current (N, n) drive unit; n joint names; extra columns (N,).
    Reading gives back every number bit for bit.

    Errors: BenchError for an unknown suffix, ValueError for shapes that do not agree.
    """
    path = Path(path)
    columns = {"time": np.asarray(time, dtype=np.float64)}
    count = columns["time"].size
    for kind, values in (("position", position), ("current", current)):
        block = np.asarray(values, dtype=np.float64)
        if block.shape != (count, len(joints)):
            raise ValueError(f"{kind} has shape {block.shape}, expected {(count, len(joints))}")
        columns |= {f"{kind}.{joint}": block[:, i] for i, joint in enumerate(joints)}
    columns |= {name: np.asarray(values, dtype=np.float64) for name, values in (extra or {}).items()}
    write_table(path, columns)


def write_table(path: Path, columns: Mapping[str, Array], progress: Progress = SILENT) -> None:
    """Write columns of equal length as CSV or Parquet, by suffix, whole or not at all; progress counts rows."""
    writer = {".csv": _write_csv, ".parquet": _write_parquet}.get(path.suffix.lower())
    if writer is None:
        raise BenchError(f"{path}: a recording is a .csv or a .parquet file")
    with atomic_path(path) as temporary:
        writer(temporary, columns, progress)


def _write_csv(path: Path, columns: Mapping[str, Array], progress: Progress) -> None:
    # repr of a float is the shortest text that reads back as the same float
    header = ",".join(f'"{name}"' if "," in name else name for name in columns)
    count = max((values.size for values in columns.values()), default=0)
    with path.open("w", encoding="utf-8") as file:
        file.write(header + "\n")
        for first in range(0, count, WRITTEN):
            part = (map(repr, values[first : first + WRITTEN].tolist()) for values in columns.values())
            file.writelines(f"{','.join(row)}\n" for row in zip(*part, strict=True))
            progress.advance(min(WRITTEN, count - first))


def _write_parquet(path: Path, columns: Mapping[str, Array], progress: Progress) -> None:
    import pyarrow as pa  # noqa: PLC0415 - takes 25 MB of memory, and most files are CSV
    import pyarrow.parquet as pq  # noqa: PLC0415

    table = pa.table({name: pa.array(values) for name, values in columns.items()})
    pq.write_table(table, path)
    progress.advance(table.num_rows)
