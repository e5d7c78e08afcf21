"""From a file to a recording that has been checked: everything found is named by file, column and row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.joint_facts import JointFacts
from bench.dataset.recording import Recording, Use, position_column
from bench.dataset.recording_checks import Channel, Fault, find
from bench.dataset.recording_window import WHOLE, Window
from bench.dataset.sampling import gap_rows, on_uniform_grid, time_fault
from bench.files.recording_fault import RecordingFaultError, Remedy
from bench.files.table import FileTable, read_table, release_tables

MOST_SPANS = 3  # that are told


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

    What is used of it in several stretches is as many recordings, since no filter may run across a cut. Only what is
    used is checked.
    """
    table = read_table(path)
    _check_columns(table, ["time"])
    parts = window.parts(table)
    recordings = [recording_from_table(part, name, use, payload, joints, accept) for part in parts]
    release_tables()
    if window == WHOLE:
        return recordings
    started = window.began(table)
    if len(recordings) == 1:
        return [replace(recordings[0], started=started)]
    return [
        replace(
            recording,
            name=f"{name} ({recording.time[0]:.4g} to {recording.time[-1]:.4g} s)",
            part_of=name,
            started=started,
        )
        for recording in recordings
    ]


def recording_from_table(
    table: FileTable,
    name: str,
    use: Use,
    payload: str | None,
    joints: Sequence[JointFacts],
    accept: Sequence[str] = (),
) -> Recording:
    """The columns of a table as a recording of the driven `joints`, on a uniform time grid.

    The redundant motors' joints come last; their positions, which the others give, are kept among
    the extra columns.
    Every check of bench.dataset.sampling and bench.dataset.recording_checks runs, but for the accepted ones.

    Errors: BenchError "FILE: column COLUMN, line N: ..." for the first fault, and how many more there are.
    """
    columns = [f"{kind}.{joint.name}" for kind in ("position", "current") for joint in joints]
    _check_columns(table, ["time", *columns])
    time = table.finite("time", lambda bad: _removed(bad, table.data.num_rows))
    signals = np.column_stack([table.finite(column, partial(_left_out, time)) for column in columns])
    if (fault := time_fault(time)) is not None:
        cure = f"; {_between_gaps(time)}" if fault.gap else ""
        raise RecordingFaultError(f"{table.place('time', fault.row)}: {fault.what}", cure, fault.remedy)
    _check_signals(table, columns, time, signals, joints, frozenset(accept))
    extra = {
        c: table.numbers(c) for c in table.columns if c and c not in ("time", *columns) and table.is_plain(c)
    }
    n = len(joints)
    time, position, current, extra = on_uniform_grid(time, signals[:, :n], signals[:, n:], extra)
    first = n - sum(joint.redundant for joint in joints)
    if first == n:
        return Recording(name, use, payload, time, position, current, extra)
    extra |= {position_column(joints[j].name): position[:, j] for j in range(first, n)}
    own, theirs = (np.ascontiguousarray(values[:, :first]) for values in (position, current))
    return Recording(name, use, payload, time, own, theirs, extra, redundant=current[:, first:])


def _removed(bad: np.ndarray, count: int) -> tuple[str, Remedy]:
    """What helps where rows (K,) of so many have no time."""
    lines = "that line" if len(bad) == 1 else "those lines"
    at_the_end = bool(bad[0] == count - len(bad))
    said = f"the file breaks off there: remove {lines}" if at_the_end else f"remove {lines}"
    return said, Remedy.REMOVE_ROWS


def _left_out(time: np.ndarray, bad: np.ndarray) -> tuple[str, Remedy]:
    """What helps where rows (K,) have no value: stretches that dataset.toml leaves out, or lines to be removed."""
    if bad[0] == len(time) - len(bad):
        return _removed(bad, len(time))
    half = 0.5 * float(np.median(np.diff(time)))
    first = np.concatenate(([True], np.diff(bad) > 1))
    last = np.concatenate((first[1:], [True]))
    spans = [
        f"[{time[a] - half:.9g}, {time[b] + half:.9g}]" for a, b in zip(bad[first], bad[last], strict=True)
    ]
    said = f"exclude = [{_listed(spans, MOST_SPANS)}] beside its file name in dataset.toml leaves it out"
    return said, Remedy.LEAVE_ROWS_OUT


def _between_gaps(time: np.ndarray) -> str:
    """What helps where samples were lost: the stretches between."""
    rows = [0, *gap_rows(time).tolist(), len(time)]
    spans = [f"[{time[a]:.9g}, {time[b - 1]:.9g}]" for a, b in pairwise(rows)]
    return (
        f"window = [{_listed(spans, MOST_SPANS)}] beside its file name in dataset.toml uses what is between"
    )


def _check_columns(table: FileTable, needed: Sequence[str]) -> None:
    there = [column for column in table.columns if column]
    missing = [column for column in needed if column not in there]
    if not missing:
        return
    close = get_close_matches(missing[0].lower(), [column.lower() for column in there], n=1, cutoff=0.8)
    hint = f"; is {next(c for c in there if c.lower() == close[0])!r} meant?" if close else ""
    raise BenchError(f"{table.path}: no column {', '.join(missing)} (it has {_listed(there)}){hint}")


def _listed(names: Sequence[str], most: int = 12) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def _check_signals(
    table: FileTable,
    columns: Sequence[str],
    time: np.ndarray,
    signals: np.ndarray,
    joints: Sequence[JointFacts],
    accepted: frozenset[str],
) -> None:
    step = float(np.median(np.diff(time)))
    found: list[tuple[str, Fault]] = []
    for i, column in enumerate(columns):
        joint = joints[i % len(joints)]
        values = np.ascontiguousarray(signals[:, i])
        position = i < len(joints)
        channel = Channel(
            values, step, joint if position else None, effort=joint.logs_effort and not position
        )
        found += [(column, finding) for finding in find(channel, accepted)]
    if not found:
        return
    column, finding = found[0]
    others = sorted({other for other, _ in found[1:] if other != column})
    more = f"; more in {', '.join(others)}" if others else ""
    accept = f" (accept = [{finding.check!r}] beside its file name if that is meant)".replace("'", '"')
    said = f"{table.place(column, finding.row)}: {finding.what}{more}"
    raise RecordingFaultError(said, accept, finding.remedy, finding.check)
