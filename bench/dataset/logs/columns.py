"""Map the vectors of a log to the columns of a recording, in SI."""

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np
import numpy.typing as npt

from bench.basics.errors import BenchError, meant, refuse
from bench.basics.plural import plural
from bench.dataset.logs.guess import guesses
from bench.dataset.logs.log_file import LogFile, Reading, read_log, text_log
from bench.dataset.logs.units import (
    UNITS,
    factor_of,
    measured_by,
    stated_units,
    unit_in,
    unit_named,
    units_of,
)
from bench.dataset.names import TEXTS
from bench.dataset.recording import velocity_column
from bench.dataset.recording_faults import listed
from bench.dataset.robot import Robot

Array = npt.NDArray[np.float64]
GROUPS = ("position", "current")
SCALED = (*GROUPS, "velocity")  # kinds of columns that a scale can name for all joints
REVERSED = -1.0  # as a scale: the sign of the column changes, its unit stays


@dataclass(frozen=True)
class LogMap:
    """Which names of a log become which columns of a recording.

    columns  column -> name in the log; columns are `time`, `position.JOINT`, `current.JOINT`, `velocity.JOINT`, and
             any other name for a column to keep for plots. A column of the first four kinds that has the same name in
             the log needs no entry.
    scale    column -> factor that turns the log's unit into SI, such as 1e-3 for millimetres, or the unit's name
             (see UNITS); `position`, `current` and `velocity` represent those of all joints. It takes precedence over
             a unit that the log states; -1 only changes the sign.
    rate     Hz, for a log without a time column; its time then starts at zero
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    scale: Mapping[str, float | str] = field(default_factory=dict)
    rate: float | None = None


@dataclass(frozen=True, eq=False)
class Columns:
    """A recording's columns (N,) in SI, `time` first; sources: their names in the log; notes: on time and units.

    faults: a line for each column that is not numeric, which is not among the values. stated: units that the log
    states, for the columns converted to SI because of them.
    """

    values: Mapping[str, Array]
    sources: Mapping[str, str]
    notes: tuple[str, ...]
    faults: tuple[str, ...] = ()
    stated: Mapping[str, str] = field(default_factory=dict)


def columns_of(file: Path, log: LogFile, robot: Robot, log_map: LogMap) -> Columns:
    """The columns of a robot's recording, from a log.

    Raises BenchError for a joint, a name or a unit that does not exist, and for vectors of different length.
    """
    reversed_ = {target: scale for target, scale in log_map.scale.items() if scale == REVERSED}
    others = {target: scale for target, scale in log_map.scale.items() if target not in reversed_}
    given, signs = (_given_factors(file, scales, robot) for scales in (others, reversed_))
    sources = _sources(file, log, robot, log_map, given | signs)
    stated = _stated_factors(file, log, robot, sources, given)
    factors = {column: factor for column, (factor, _) in stated.items()} | given
    factors |= {column: sign * factors.get(column, 1.0) for column, sign in signs.items()}
    values, faults, clock = {}, [], log.clock(sources["time"]) if "time" in sources else None
    if clock is not None:
        values["time"] = clock
    for column, source in sources.items():
        if column in values:
            continue
        try:
            values[column] = log.numbers(source) * factors.get(column, 1.0)
        except BenchError as error:
            faults.append(str(error))
    if not any(column.startswith("position.") for column in values) or (
        log_map.rate is None and "time" not in values
    ):
        refuse(faults)
    if log_map.rate is not None:
        first = next(column for column in values if column.startswith("position."))
        values = {"time": np.arange(values[first].size) / log_map.rate} | values
    count = values["time"].size
    wrong = [
        f"{sources[column]!r} for {column} has {plural(samples.size, 'sample')}"
        for column, samples in values.items()
        if samples.size != count
    ]
    refuse([f"{file}: {said}, time has {count}" for said in wrong])
    ordered = {name: values[name] for name in sorted(values, key=lambda name: name != "time")}
    turned = {column: unit for column, (factor, unit) in stated.items() if factor != 1.0}
    notes = (*_unit_notes(turned), *_name_notes(sources, factors, robot))
    if clock is not None:
        notes = ("time: in seconds from the first, which is a time of day or a date", *notes)
    return Columns(ordered, sources, notes, tuple(faults), turned)


def _unit_notes(units: Mapping[str, str]) -> tuple[str, ...]:
    by_unit: dict[str, list[str]] = {}
    for column, unit in units.items():
        by_unit.setdefault(unit, []).append(column)
    return tuple(f"{', '.join(columns)}: in {unit}, as the log says" for unit, columns in by_unit.items())


def _name_notes(sources: Mapping[str, str], factors: Mapping[str, float], robot: Robot) -> tuple[str, ...]:
    """Notes on units that appear only in the names of columns: neither the log nor a scale gives them."""
    notes = []
    for column, source in sources.items():
        if column in factors or measured_by(column, robot) is None:
            continue
        units = units_of(column, robot)
        if (unit := unit_in(source, units)) not in ("", units[0]):
            notes.append(
                f"{source} for {column}: assumed to be in {units[0]}; if it is in {unit}, add --scale {column}={unit}"
            )
    return tuple(notes)


def _given_factors(file: Path, scale: Mapping[str, float | str], robot: Robot) -> dict[str, float]:
    """Factors by column: unit names become factors, and a scale for all joints becomes one for each."""
    factors: dict[str, float] = {}
    for target, given in scale.items():
        unit = unit_named(given) if isinstance(given, str) else None
        if isinstance(given, str) and unit is None:
            raise BenchError(f"{file}: the scale of {target}: no unit {given!r}; {meant(given, UNITS)}")
        factor = float(given) if unit is None else unit.factor
        columns = [f"{target}.{joint}" for joint in robot.driven] if target in SCALED else [target]
        if unit is not None:
            columns = [column for column in columns if measured_by(column, robot) in (None, unit.of)]
            if not columns:
                raise BenchError(f"{file}: the scale of {target}: {given!r} is a {unit.of}")
        if not np.isfinite(factor) or factor == 0.0:
            raise BenchError(f"{file}: the scale of {target} must not be {factor:g}")
        factors |= dict.fromkeys(columns, factor)
    return factors


def _stated_factors(
    file: Path, log: LogFile, robot: Robot, sources: Mapping[str, str], given: Mapping[str, float]
) -> dict[str, tuple[float, str]]:
    """Factor and unit by column, for units that the log states and no scale overrides."""
    factors: dict[str, tuple[float, str]] = {}
    for column, source in sources.items():
        if (unit := log.units.get(source)) is not None and column not in given:
            factor = factor_of(f"{file}: {source!r}", unit, column, robot)
            if factor is not None:
                factors[column] = factor, unit
    return factors


def _sources(
    file: Path, log: LogFile, robot: Robot, log_map: LogMap, given: Mapping[str, float]
) -> dict[str, str]:
    """Column -> its name in the log, for all columns of the recording."""
    needed = [f"{kind}.{joint}" for kind in GROUPS for joint in robot.driven]
    if log_map.rate is None:
        needed.insert(0, "time")
    elif "time" in log_map.columns:
        raise BenchError(f"{file}: give a rate or map time, not both")
    elif not (np.isfinite(log_map.rate) and log_map.rate > 0.0):
        raise BenchError(f"{file}: the rate must be positive, not {log_map.rate:g} Hz")
    there = [*log.vectors, *log.texts]
    velocities = [velocity_column(joint) for joint in robot.driven]
    kept = [*needed, *velocities]
    known = kept if any(name in there or name in log_map.columns for name in velocities) else needed
    _check_targets(file, log_map, given, known, robot)
    sources = {target: target for target in kept if target in there} | dict(log_map.columns)
    missing = [target for target in needed if target not in sources]
    if missing:
        what = f"nothing is mapped to {', '.join(missing)} (the log has {_inventory(log)})"
        raise BenchError(
            f"{file}: {what}{_misspelt(missing, log_map)}"
            f"{_proposed(missing, sources, log, robot) or _example(missing[0], sources, there, robot)}"
            f"{_skipping(log, sources, robot)}"
        )
    absent = [(target, source) for target, source in sources.items() if source not in there]
    if absent:
        named = ", ".join(f"{source!r} for {target}" for target, source in absent)
        free = [name for name in there if name not in sources.values()]
        near = [name for _, source in absent for name in _nearest(source, free)]
        hint = (
            f": did you mean {' or '.join(map(repr, dict.fromkeys(near)))}?"
            if len(near) == len(absent)
            else ""
        )
        raise BenchError(
            f"{file}: there is no {named}{hint} (the log has {_inventory(log)}){_skipping(log, sources, robot)}"
        )
    return sources


def _nearest(source: str, there: Sequence[str]) -> list[str]:
    """The column with the nearest name, compared with and without units in brackets; empty if none is near."""
    bare = {name.partition("[")[0].partition("(")[0].strip() or name: name for name in there}
    near = get_close_matches(source, there, 1) or get_close_matches(source, list(bare), 1)
    return [bare.get(name, name) for name in near]


def _misspelt(missing: Sequence[str], log_map: LogMap) -> str:
    """The hint for a mapped column whose name is a near miss of a missing one; "" if there is none."""
    for target in log_map.columns:
        if near := get_close_matches(target, missing, 1, cutoff=0.75):
            return f"; {target!r} is no column that is needed: did you mean {near[0]!r}?"
    return ""


def _proposed(missing: Sequence[str], sources: Mapping[str, str], log: LogFile, robot: Robot) -> str:
    """The options that map all missing columns, if the names of the log's columns suggest them all; else ""."""
    stated = stated_units(log.units)
    there = [name for name in (*log.vectors, *log.texts) if name not in sources.values()]
    guessed = guesses(there, robot, stated, log.vectors)
    if not set(missing) <= set(guessed):
        return ""
    options = [f"--map {target}={shlex.quote(guessed[target]['column'])}" for target in missing]
    for target in missing:
        unit, column = guessed[target]["unit"], guessed[target]["column"]
        if column not in stated and unit not in ("", units_of(target, robot)[0]):
            options.append(f"--scale {target}={unit}")
    first = guessed[missing[0]]
    known = first["unit"] or first["column"] in stated
    hint = "" if known else _unit_hint(missing[0], "", robot)
    ordered = any(guessed[target]["why"] == "order" for target in missing)
    by = "by their names and their order" if ordered else "by their names"
    return f"; {by} these may be right, look at each: {' '.join(options)}{hint}"


def _example(target: str, sources: Mapping[str, str], there: Sequence[str], robot: Robot) -> str:
    """An example that maps a missing column to a free one, with its unit."""
    free = [name for name in there if name not in sources.values()]
    if not free:
        return ""
    hint = _unit_hint(target, unit_in(free[0], units_of(target, robot)), robot)
    return f"; say which is which, as in --map {target}={shlex.quote(free[0])}{hint}"


def _unit_hint(target: str, unit: str, robot: Robot) -> str:
    """The option for a column's unit: the given one, else the first that is not SI; "" if there is none."""
    si, *others = units_of(target, robot)
    unit = unit or next(iter(others), "")
    return f" (with --scale {target}={unit} where it is in {unit})" if unit not in ("", si) else ""


def _check_targets(
    file: Path, log_map: LogMap, given: Mapping[str, float], known: Sequence[str], robot: Robot
) -> None:
    for target in (*log_map.columns, *given):
        if target not in known and target.startswith(("position.", "current.")):
            joints = ", ".join(robot.driven)
            raise BenchError(f"{file}: {target!r}: the robot {robot.name!r} drives {joints}")
    for target in given:
        if target not in known and target not in log_map.columns:
            raise BenchError(f"{file}: {target!r} has a scale but nothing is mapped to it")


def _skipping(log: LogFile, sources: Mapping[str, str], robot: Robot) -> str:
    """The cure if a text has none of the columns, and no name like one: its column names may be below a preamble."""
    there = [*log.vectors, *log.texts]
    if log.lines is None or any(source in there for source in sources.values()):
        return ""
    if guesses(there, robot, stated_units(log.units)):
        return ""
    return "; if a preamble precedes the column names, skip it with --skip-rows N"


def _inventory(log: LogFile) -> str:
    names = [f"{name} ({values.size})" for name, values in log.vectors.items()]
    return listed([*names, *(f"{name} (with text)" for name in log.texts)], 30)


LARGE = 1 << 25  # bytes: of a larger text, a preview reads only pieces
HEAD, PIECE, PIECES = 1 << 18, 1 << 14, 255  # bytes of the beginning, bytes of a piece, number of pieces
WHOLE_LINES = re.compile(rb"[\r\n](.*[\r\n])", re.DOTALL)


def glimpse(path: Path, reading: Reading) -> LogFile:
    """The log as `read_log` returns it; of a large text only the rows of its beginning and of evenly spaced pieces.

    A note says so. A text that cannot be read in pieces is read whole. Raises BenchError as `read_log` does.
    """
    if path.suffix.lower() not in TEXTS or not path.is_file() or (size := path.stat().st_size) <= LARGE:
        return read_log(path, reading)
    try:
        log = text_log(path, _pieces(path, size), reading)
    except BenchError:  # only the whole text gives the line of a fault in a piece
        return read_log(path, reading)
    said = (
        f"{size / 2**20:.0f} MB: the beginning and {PIECES} pieces from all over it are shown; every row is read when "
        "the columns are checked, and again when it is imported"
    )
    return replace(log, notes=(*log.notes, said))


def _pieces(path: Path, size: int) -> bytes:
    """The beginning and evenly spaced pieces, all of whole lines."""
    with path.open("rb") as file:
        head = file.read(HEAD)
        parts = [head[: max(head.rfind(b"\n"), head.rfind(b"\r")) + 1]]
        for start in np.linspace(HEAD, size - PIECE, PIECES).astype(int):
            file.seek(start)
            if match := WHOLE_LINES.search(file.read(PIECE)):
                parts.append(match.group(1).lstrip(b"\r\n"))
    return b"".join(parts)
