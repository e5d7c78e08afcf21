"""All faults of the columns that a recording needs, each with its cure."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations, pairwise

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.recording_fault import IN_UNIT, RecordingFaultError, Remedy
from bench.basics.files.table import FileTable
from bench.dataset.joint_facts import JointFacts
from bench.dataset.recording_checks import LIMIT_SLACK, Array, Channel, Fault, find
from bench.dataset.sampling import FEWEST, LIKE, TimeFault, cut_rows, gap_rows, stamp_to, time_fault

MOST_SPANS = 3  # number of stretches that a message lists
SECONDS = {remedy: 1.0 / factor for factor, (_, remedy) in LIKE.items()}
"""Remedy for a time in another unit -> that unit in seconds."""


def faults_of(
    table: FileTable, joints: Sequence[JointFacts], accepted: frozenset[str]
) -> list[RecordingFaultError]:
    """Every fault of a recording of the driven `joints`: cells that are not numbers, then the time, then the signals.

    A column that is not in the table is skipped. Every check of bench.dataset.sampling and
    bench.dataset.recording_checks runs, except for the accepted ones.
    """
    faults: list[RecordingFaultError] = []
    time = _read(table, "time", faults)
    by_name = {joint.name: joint for joint in joints}
    columns = [f"{kind}.{name}" for kind in ("position", "current") for name in by_name]
    there = {column: _read(table, column, faults, time) for column in columns if column in table.columns}
    if time is None:
        return faults
    fault = time_fault(time)
    if fault is not None:
        cure = f"; {_between_gaps(time)}" if fault.remedy is Remedy.CUT_AT_GAPS else _imported(fault.remedy)
        said = f"{table.place('time', fault.row)}: {fault.what}"
        faults.append(RecordingFaultError(said, cure, fault.remedy, column="time"))
    if fault is not None and fault.row is None and fault.remedy not in SECONDS:
        return faults  # the sampling rate is unknown
    signals = {column: values for column, values in there.items() if values is not None}
    findings = signal_faults(signals, by_name, time, fault, accepted)
    return [*faults, *(_fault_of(table, column, finding) for column, finding in findings)]


def signal_faults(
    signals: Mapping[str, Array],
    joints: Mapping[str, JointFacts],
    time: Array,
    fault: TimeFault | None,
    accepted: frozenset[str],
) -> Iterator[tuple[str, Fault]]:
    """The findings in columns (N,) of positions and currents, each with its column. fault: of the time (N,)."""
    positions = {name: signals[column] for name in joints if (column := f"position.{name}") in signals}
    swapped = exchanged({} if "limits" in accepted else positions, list(joints.values()))
    for column, values in signals.items():
        kind, _, name = column.partition(".")
        findings = faults_in(column, values, time, joints[name], fault, accepted)
        if kind == "position":
            findings = without_exchange(findings, swapped.get(name))
        yield from ((column, finding) for finding in findings)


def _read(
    table: FileTable, column: str, faults: list[RecordingFaultError], time: np.ndarray | None = None
) -> np.ndarray | None:
    """A column of measurements; None if a cell is not a number, which is added to the faults."""
    try:
        if column == "time":
            return table.finite(column, lambda bad: _removed(bad, table.data.num_rows))
        return table.finite(column, None if time is None else partial(_left_out, time))
    except RecordingFaultError as fault:
        faults.append(fault)
    except BenchError as error:
        faults.append(RecordingFaultError(str(error), column=column))
    return None


def faults_in(
    column: str,
    values: np.ndarray,
    time: np.ndarray,
    joint: JointFacts,
    fault: TimeFault | None,
    accepted: frozenset[str],
) -> list[Fault]:
    """The findings in a log; with cuts, in its longest stretch; with a wrong unit of time, at the corrected rate."""
    start, stop = 0, time.size
    if fault is not None and fault.remedy in (Remedy.CUT_AT_GAPS, Remedy.CUT_WHERE_BACK):
        pieces = pairwise([0, *cut_rows(time).tolist(), time.size])
        start, stop = max(pieces, key=lambda piece: piece[1] - piece[0])
    step = float(np.median(np.abs(np.diff(time[start:stop]))))
    if fault is not None and fault.remedy in SECONDS:
        step *= SECONDS[fault.remedy]
    if not step > 0.0:
        return []
    samples = np.ascontiguousarray(values[start:stop])
    if column.startswith("position."):
        channel = Channel(samples, step, joint)
    else:
        channel = Channel(samples, step, effort=joint.logs_effort)
    return [
        finding if finding.row is None else replace(finding, row=finding.row + start)
        for finding in find(channel, accepted)
    ]


def _fault_of(table: FileTable, column: str, finding: Fault) -> RecordingFaultError:
    accept = f" (accept = [{finding.check!r}] under its file name if that is intended)".replace("'", '"')
    said = f"{table.place(column, finding.row)}: {finding.what}"
    return RecordingFaultError(
        said, f"{_imported(finding.remedy)}{accept}", finding.remedy, finding.check, column=column
    )


def _imported(remedy: Remedy | None) -> str:
    """The import option that cures a column in another unit or a time that runs backwards; "" for other faults."""
    if remedy is Remedy.CUT_WHERE_BACK:
        return "; bench import --split-gaps cuts such a log there"
    if remedy is None or remedy not in IN_UNIT:
        return ""
    return f"; bench import --scale {'='.join(IN_UNIT[remedy])} turns such a log into a recording"


def _removed(bad: np.ndarray, count: int) -> tuple[str, Remedy]:
    """The cure if the rows `bad` (K,), of `count` in all, lack a value, and its remedy."""
    if len(bad) == count:
        return "the column has no measurement at all: is it the right one?", Remedy.OTHER_COLUMN
    lines = "that line" if len(bad) == 1 else "those lines"
    at_the_end = bool(bad[0] == count - len(bad))
    said = f"the file breaks off there: remove {lines}" if at_the_end else f"remove {lines}"
    return said, Remedy.REMOVE_ROWS


def _left_out(time: np.ndarray, bad: np.ndarray) -> tuple[str, Remedy]:
    """The cure if the rows `bad` (K,) lack a value: stretches to exclude in dataset.toml, or lines to remove."""
    if bad[0] == len(time) - len(bad):
        return _removed(bad, len(time))
    step = float(np.median(np.diff(time)))
    first = np.concatenate(([True], np.diff(bad) > 1))
    last = np.concatenate((first[1:], [True]))
    spans = [
        _span(time[a] - 0.5 * step, time[b] + 0.5 * step, step)
        for a, b in zip(bad[first], bad[last], strict=True)
    ]
    said = f"exclude = [{listed(spans, MOST_SPANS)}] under its file name in dataset.toml excludes it"
    return said, Remedy.LEAVE_ROWS_OUT


def _between_gaps(time: np.ndarray) -> str:
    """The cure for lost samples: the stretches between gaps, except for those with too few samples."""
    rows, step = [0, *gap_rows(time).tolist(), len(time)], float(np.median(np.diff(time)))
    spans = [_span(time[a], time[b - 1], step, 1) for a, b in pairwise(rows) if b - a >= FEWEST]
    if not spans:
        return f"no stretch between gaps has the {FEWEST} samples that are needed"
    return f"window = [{listed(spans, MOST_SPANS)}] under its file name in dataset.toml uses the part between them"


def _span(start: float, end: float, step: float, outward: int = 0) -> str:
    """A stretch as in dataset.toml, rounded to a tenth of a step. outward: 1 if rounding must not shorten it."""
    return f"[{stamp_to(start, 0.1 * step, -outward)}, {stamp_to(end, 0.1 * step, outward)}]"


def listed(names: Sequence[str], most: int = 12) -> str:
    """Names separated by commas; if there are more than `most`, the first of them and the number of the others."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def exchanged(positions: Mapping[str, Array], joints: Sequence[JointFacts]) -> dict[str, JointFacts]:
    """Joint -> the joint with which its column is swapped: for both, the positions are outside the joint's range but
    inside that of the other. positions: (N,) by joint, rad or m.
    """
    by_name: dict[str, JointFacts] = {}
    there = [joint for joint in joints if joint.name in positions]
    for first, second in combinations(there, 2):
        ours, theirs = positions[first.name], positions[second.name]
        outside = not (_inside(ours, first) or _inside(theirs, second))
        if outside and _inside(ours, second) and _inside(theirs, first):
            by_name |= {first.name: second, second.name: first}
    return by_name


def without_exchange(findings: Sequence[Fault], other: JointFacts | None) -> list[Fault]:
    """Findings of a column; if it is swapped with that of another joint, this replaces findings of units and limits."""
    kept = [finding for finding in findings if finding.check not in ("units", "limits")]
    if other is None or len(kept) == len(findings):
        return list(findings)
    said = (
        f"lies in the range of {other.name}, [{other.lower:g}, {other.upper:g}], and position.{other.name} in the "
        "range of this joint: are the two columns swapped?"
    )
    return [Fault("limits", None, said), *kept]


def _inside(values: Array, joint: JointFacts) -> bool:
    """Whether positions lie in a joint's range, with the tolerance of the check `limits`; False if it has no range."""
    if joint.lower is None or joint.upper is None or not values.size:
        return False
    slack = LIMIT_SLACK * (joint.upper - joint.lower)
    return bool(np.nanmin(values) >= joint.lower - slack and np.nanmax(values) <= joint.upper + slack)
