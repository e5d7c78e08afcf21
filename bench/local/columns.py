"""What the columns of a log may be: joints by their names, units by what the log or a name says."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.dataset.logs.columns import GROUPS
from bench.dataset.logs.glimpse import glimpse
from bench.dataset.logs.log_file import LogFile, Reading
from bench.dataset.logs.ros_bag import is_bag, joint_topics
from bench.dataset.logs.unit_names import LAST, name_of, unit_in, units_of
from bench.dataset.logs.units import UNITS
from bench.dataset.robot import Robot

POINTS = 160  # of a column's small picture

TIME = frozenset({"time", "timestamp", "t", "zeit", "clock"})
POSITION = frozenset(
    {"position", "positions", "pos", "q", "qm", "qs", "angle", "ang", "theta", "enc", "encoder", "joint", "x"}
    | {"winkel", "stellung", "angulo", "posicion"}
)
CURRENT = frozenset(
    {"current", "currents", "cur", "curr", "i", "iq", "amp", "amps", "effort", "torque", "tau", "vir", "u"}
    | {"strom", "drehmoment", "courant", "couple", "corriente"}
)
PLACES, DRIVES = ("angle", "length"), ("current", "voltage", "torque", "force")
"""What the units of positions and of currents measure."""


def look_at(path: str, robot: Robot, topic: str | None = None, skip_rows: int = 0) -> dict[str, Any]:
    """The columns of the log in a file; see `columns_of`. Raises BenchError where it cannot be read.

    topics: those of a ROS bag that hold joint states; of several, one must be named before there are columns.
    skip_rows: lines on top of a text to leave out.
    """
    topics = joint_topics(Path(path)) if is_bag(Path(path)) else ()
    if len(topics) > 1 and topic is None:
        return {"topics": topics}
    return {**columns_of(glimpse(Path(path), Reading(skip_rows, topic=topic)), robot), "topics": topics}


def columns_of(log: LogFile, robot: Robot) -> dict[str, Any]:
    """Every column with its small picture; for those that a recording needs, which they may be, and in which units.

    stated: the unit that the log itself gives, which an import takes unless it is told another. units: the first is SI.
    """
    names = [*log.vectors, *log.texts]
    stated = {name: unit for name, text in log.units.items() if (unit := name_of(text))}
    columns = [{"name": name, **_seen(log.vectors.get(name, np.empty(0)))} for name in names]
    needs = ["time", *(f"{kind}.{joint}" for kind in GROUPS for joint in robot.driven)]
    return {
        "robot": robot.name,
        "needs": needs,
        "columns": columns,
        "stated": stated,
        "guesses": guesses(names, robot, stated),
        "units": {column: units_of(column, robot) for column in needs},
        "notes": list(log.notes),
    }


def guesses(
    names: Sequence[str], robot: Robot, stated: Mapping[str, str] | None = None
) -> dict[str, dict[str, str]]:
    """Needed column -> {column, unit, why} for those whose names or units tell; a person confirms them.

    stated: units by column as the log gives them; in a language that is not known here, they tell what is what.
    why is "name" where the log's name holds the joint's, and "order" where names are numbered as the joints are.
    """
    found: dict[str, tuple[str, str]] = {}
    time = next((name for name in names if (words := _words(name)) and words[0] in TIME), None)
    if time is not None:
        found["time"] = time, "name"
    for kind, spoken, measured in (("position", POSITION, PLACES), ("current", CURRENT, DRIVES)):
        free = [name for name in names if name != time and spoken & set(_words(name))]
        if not free:
            free = [name for name in names if name != time and _measures(name, stated) in measured]
        named, why = _by_name(free, robot.driven), "name"
        numbered = [name for name in free if re.search(r"\d", _stem(name)) or len(robot.driven) == 1]
        in_order = not robot.redundant and len(numbered) == len(robot.driven)
        if not named and in_order:
            named, why = dict(zip(robot.driven, sorted(numbered, key=_number), strict=True)), "order"
        found |= {f"{kind}.{joint}": (name, why) for joint, name in named.items()}
    return {
        target: {"column": name, "unit": unit_in(name, units_of(target, robot)), "why": why}
        for target, (name, why) in found.items()
    }


def _measures(name: str, stated: Mapping[str, str] | None) -> str:
    """What a column's unit measures, stated or in its name; "" where there is none."""
    match = LAST.match(name)
    unit = (stated or {}).get(name) or (name_of(match.group(2)) if match else None)
    return UNITS[unit].of if unit else ""


def _by_name(names: Sequence[str], joints: Sequence[str]) -> dict[str, str]:
    """Joint -> the one name that holds all words and numbers of the joint's."""
    found = {}
    for joint in joints:
        wanted = set(_parts(joint))
        holding = [name for name in names if wanted <= set(_parts(_stem(name)))]
        if len(holding) == 1:
            found[joint] = holding[0]
    return found if len(set(found.values())) == len(found) else {}


def _stem(name: str) -> str:
    """A name without the unit that it ends in: t_ms -> t; a lone letter, as in motor.m, is more than a unit."""
    match = LAST.match(name)
    return match.group(1) if match and name_of(match.group(2)) else name


def _parts(name: str) -> list[str]:
    return [part.lower() for part in re.findall(r"[^\W\d_]+|\d+", name)]


def _words(name: str) -> list[str]:
    return [part for part in _parts(_stem(name)) if not part.isdigit()]


def _number(name: str) -> tuple[int, ...]:
    return tuple(int(part) for part in _parts(_stem(name)) if part.isdigit())


def _seen(values: np.ndarray) -> dict[str, Any]:
    """Range and a few evenly spaced values."""
    known = values[np.isfinite(values)]
    rows = np.unique(np.linspace(0, max(values.size - 1, 0), min(POINTS, values.size)).astype(int))
    return {
        "low": float(known.min()) if known.size else None,
        "high": float(known.max()) if known.size else None,
        "picture": [float(value) if np.isfinite(value) else None for value in values[rows]],
    }
