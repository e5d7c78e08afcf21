"""Read a file as a checked recording: faults are reported by file, column and row."""

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.table import FileTable, read_table
from bench.dataset.joint_facts import JointFacts
from bench.dataset.names import Use
from bench.dataset.recording import Recording, position_column
from bench.dataset.recording_faults import faults_of, listed
from bench.dataset.recording_window import WHOLE, Window
from bench.dataset.sampling import on_uniform_grid, repeated_rows, stamp_to


def load_recordings(
    path: Path,
    name: str,
    use: Use,
    payload: str | None,
    joints: Sequence[JointFacts],
    accept: Sequence[str] = (),
    window: Window = WHOLE,
) -> list[Recording]:
    """Read the CSV or Parquet file `path` as a recording of the driven `joints`; see recording_from_table.

    Each used stretch becomes a separate recording, as no filter may run across a cut. Only used samples are checked.
    """
    table = read_table(path)
    _check_columns(table, ["time"])
    parts = window.parts(table)
    recordings = [recording_from_table(part, name, use, payload, joints, accept) for part in parts]
    if window == WHOLE:
        return recordings
    started = float(np.nanmin(table.stamps()))
    if len(recordings) == 1:
        return [replace(recordings[0], started=started)]
    parted = []
    for recording in recordings:
        ends = recording.time[[0, -1]].tolist()
        span = " to ".join(stamp_to(end, 1e-3 * (ends[1] - ends[0])) for end in ends)
        parted.append(replace(recording, name=f"{name} ({span} s)", part_of=name, started=started))
    return parted


def recording_from_table(
    table: FileTable,
    name: str,
    use: Use,
    payload: str | None,
    joints: Sequence[JointFacts],
    accept: Sequence[str] = (),
) -> Recording:
    """The columns of a table as a recording of the driven `joints`, on a uniform time grid.

    The joints of redundant motors come last; their positions, which follow from the others, are kept among the extra
    columns. Every check of `sampling` and `recording_checks` runs, except for the accepted ones.

    Errors: RecordingFaultError "FILE: column COLUMN, line N: ..." for the first fault, which contains all others; a
    BenchError if columns are missing.
    """
    columns = [f"{kind}.{joint.name}" for kind in ("position", "current") for joint in joints]
    _check_columns(table, ["time", *columns])
    if faults := faults_of(table, joints, frozenset(accept)):
        raise faults[0].among(tuple(faults[1:]))
    time = table.numbers("time")
    signals = np.column_stack([table.numbers(column) for column in columns])
    others = [column for column in table.columns if column and column not in ("time", *columns)]
    extra = {column: table.numbers(column) for column in others if table.is_plain(column)}
    n = len(joints)
    repeated = repeated_rows(signals[:, :n], signals[:, n:])
    held = float(repeated.mean())
    time, position, current, extra = on_uniform_grid(time, signals[:, :n], signals[:, n:], extra, repeated)
    first = n - sum(joint.redundant for joint in joints)
    redundant = current[:, first:] if first < n else None
    if first < n:
        extra |= {position_column(joints[j].name): position[:, j] for j in range(first, n)}
        position, current = (np.ascontiguousarray(values[:, :first]) for values in (position, current))
    return Recording(name, use, payload, time, position, current, extra, redundant=redundant, held=held)


def _check_columns(table: FileTable, needed: Sequence[str]) -> None:
    there = [column for column in table.columns if column]
    missing = [column for column in needed if column not in there]
    if not missing:
        return
    close = get_close_matches(missing[0].lower(), [column.lower() for column in there], n=1, cutoff=0.8)
    hint = f"; is {next(c for c in there if c.lower() == close[0])!r} meant?" if close else ""
    raise BenchError(f"{table.path}: no column {', '.join(missing)} (it has {listed(there)}){hint}")
