"""The faults that an import would report in a log, column by column, with remedies; nothing is written."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.recording_fault import IN_UNIT, Remedy
from bench.basics.files.table import HUGE, release_tables
from bench.basics.plural import plural
from bench.dataset.joint_facts import JointFacts, joint_facts
from bench.dataset.logs.columns import GROUPS
from bench.dataset.logs.log_file import LogFile, Reading, read_log
from bench.dataset.logs.segments import SHORTEST, Cutting, cut
from bench.dataset.logs.unit_cures import CUTS
from bench.dataset.logs.units import UNITS, factor_of, name_of
from bench.dataset.recording_checks import Fault
from bench.dataset.recording_faults import signal_faults
from bench.dataset.robot import Robot
from bench.dataset.sampling import TimeFault, time_fault

CUT = {"split_gaps": True}  # the remedy for lost samples, and for time that goes back
UNTOLD = 1e3  # Hz: assumed for a log whose time is not known yet


@dataclass(frozen=True)
class Mapped:
    """How a log is to be imported. columns: column of the recording -> column of the log.

    scale: the given units or factors, by column of the recording; split_gaps: whether the log is cut at gaps. topic: of
    a ROS bag. skip_rows: lines to skip at the top.
    """

    columns: Mapping[str, str]
    scale: Mapping[str, str | float]
    rate: float | None = None
    split_gaps: bool = False
    accept: Sequence[str] = ()
    topic: str | None = None
    skip_rows: int = 0


def checked(path: str, robot: Robot, mapped: Mapped) -> dict[str, Any]:
    """Mapped column of the recording -> {ok, problems: [{what, where, remedy}]}.

    remedy: {"unit": its name}, {"split_gaps": true}, {"accept": the check}, or None.
    Raises BenchError if the file is not a log.
    """
    log = _log(Path(path), Reading(mapped.skip_rows, topic=mapped.topic))
    joints = {joint.name: joint for joint in joint_facts(robot)}
    by_target: dict[str, list[dict[str, Any]]] = {}
    series: dict[str, np.ndarray] = {}
    for target, source in mapped.columns.items():
        series[target], by_target[target] = _read(log, robot, target, source, mapped.scale.get(target))
    for piece, row in _pieces(log, series, mapped, by_target):
        _judge(log, piece, row, joints, mapped, by_target)
    for target, problems in by_target.items():
        given = mapped.scale.get(target, name_of(log.units.get(mapped.columns[target], "")))
        for problem in problems:
            problem["remedy"] = _in_place(problem["remedy"], given)
    return {target: {"ok": not problems, "problems": problems} for target, problems in by_target.items()}


def _log(path: Path, reading: Reading) -> LogFile:
    """The log, cached for the next check of it."""
    if not path.is_file():
        return read_log(path, reading)
    state = path.stat()
    return _read_once(path, (state.st_size, state.st_mtime_ns), reading)


@lru_cache(maxsize=1)
def _read_once(path: Path, _state: tuple[int, int], reading: Reading) -> LogFile:
    return read_log(path, reading)


def forget() -> None:
    """Free the memory of the log that was checked last."""
    _read_once.cache_clear()
    release_tables()


def _pieces(
    log: LogFile, series: Mapping[str, np.ndarray], mapped: Mapped, by_target: dict[str, list[dict[str, Any]]]
) -> list[tuple[Mapping[str, np.ndarray], int]]:
    """Parts of a log that become recordings, each with its first row: the whole log, or the parts that an import makes.

    If the log is cut, rows without a measurement are no longer a problem; a log of which nothing remains has a problem
    of its time.
    """
    count = next((values.size for values in series.values()), 0)
    time = series.get("time") if mapped.rate is None else np.arange(count) / mapped.rate
    if not mapped.split_gaps or time is None or any(values.size != time.size for values in series.values()):
        return [(series, 0)]
    for target, problems in by_target.items():
        by_target[target] = [problem for problem in problems if problem["remedy"] != CUT]
    try:
        parts, _ = cut(log.path, {**series, "time": time}, "identify", "log.csv", Cutting(shortest=SHORTEST))
    except BenchError as error:
        said = _problem(log, "time", str(error).removeprefix(f"{log.path}: "), None, None)
        by_target["time" if "time" in by_target else next(iter(by_target))].append(said)
        return []
    return [({target: part.columns[target] for target in series}, part.first_row) for part in parts]


def _judge(
    log: LogFile,
    series: Mapping[str, np.ndarray],
    first: int,
    joints: Mapping[str, JointFacts],
    mapped: Mapped,
    by_target: Mapping[str, list[dict[str, Any]]],
) -> None:
    """Add the problems of a piece of a log, in columns without one so far. first: its first row in the log."""

    def add(target: str, fault: Fault | TimeFault) -> None:
        row = None if fault.row is None else fault.row + first
        check = fault.check if isinstance(fault, Fault) else None
        by_target[target].append(_problem(log, target, fault.what, row, fault.remedy, check))

    signals = {
        target: values
        for target, values in series.items()
        if not by_target[target] and target.partition(".")[0] in GROUPS and target.partition(".")[2] in joints
    }
    time, fault = series.get("time") if mapped.rate is None else None, None
    if time is None or by_target["time"]:
        count = max((values.size for values in signals.values()), default=0)
        time = np.arange(count) / (mapped.rate or UNTOLD)
    elif (fault := time_fault(time)) is not None:
        add("time", fault)
    for target in [target for target, values in signals.items() if values.size != time.size]:
        add(
            target, TimeFault(None, f"has {plural(signals.pop(target).size, 'sample')}, time has {time.size}")
        )
    if time.size > 1:
        for target, finding in signal_faults(signals, joints, time, fault, frozenset(mapped.accept)):
            add(target, finding)


def _read(
    log: LogFile, robot: Robot, target: str, source: str, unit: str | float | None
) -> tuple[np.ndarray, list[dict[str, Any]]]:
    """The values of a column in SI, and its problems; no values if they cannot be read."""
    try:
        factor = _factor(log, robot, target, source, unit)
        values = log.numbers(source) * factor
    except BenchError as error:
        return np.empty(0), [{"what": str(error).removeprefix(f"{log.path}: "), "where": "", "remedy": None}]
    except KeyError:
        raise BenchError(f"{log.path.name}: there is no column {source!r}") from None
    bad = np.flatnonzero(~(np.abs(values) < HUGE))
    if bad.size:
        more = f" (and {bad.size - 1} more rows)" if bad.size > 1 else ""
        what = f"is {values[bad[0]]:g}, which is no measurement{more}"
        return values, [_problem(log, target, what, int(bad[0]), Remedy.LEAVE_ROWS_OUT)]
    return values, []


def _factor(log: LogFile, robot: Robot, target: str, source: str, unit: str | float | None) -> float:
    if unit is None:
        stated = log.units.get(source)
        return 1.0 if stated is None else factor_of(f"{source!r}", stated, target, robot) or 1.0
    if isinstance(unit, str) and unit not in UNITS:
        raise BenchError(f"no unit {unit!r}")
    return UNITS[unit].factor if isinstance(unit, str) else unit


def _problem(
    log: LogFile, target: str, what: str, row: int | None, remedy: Remedy | None, check: str | None = None
) -> dict[str, Any]:
    where = ""
    if row is not None:
        where = log.table.row_name(row) if log.table is not None else f"row {row}"
    return {"what": what, "where": where, "remedy": _remedy(remedy, target, check)}


def _in_place(remedy: dict[str, Any] | None, given: str | float | None) -> dict[str, Any] | None:
    """The remedy, its unit combined with the `given` one of the checked values; None if no unit has that factor."""
    if remedy is None or "unit" not in remedy or given is None:
        return remedy
    like = UNITS[remedy["unit"]]
    factor = like.factor * (UNITS[given].factor if isinstance(given, str) else given)
    for name, unit in UNITS.items():
        if unit.of == like.of and np.isclose(unit.factor, factor, rtol=1e-9, atol=0.0):
            return {"unit": name}
    return None


def _remedy(remedy: Remedy | None, target: str, check: str | None) -> dict[str, Any] | None:
    """The remedy for a column, in the form that `checked` gives, or the name that switches the check off."""
    if remedy is not None and remedy in IN_UNIT and IN_UNIT[remedy][0] == target.partition(".")[0]:
        return {"unit": IN_UNIT[remedy][1]}
    if remedy in CUTS:
        return dict(CUT)
    return {"accept": check} if check is not None else None
