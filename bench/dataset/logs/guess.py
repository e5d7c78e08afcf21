"""Guess which columns of a log are which of a recording: joints by name, units as the log or a name states them."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from bench.basics.files.recording_fault import IN_UNIT
from bench.basics.joint_units import units_of_gain
from bench.dataset.joint_facts import JointFacts, joint_facts
from bench.dataset.logs.units import LAST, UNITS, measured_by, name_of, unit_in, units_of
from bench.dataset.recording_checks import Channel, position_units
from bench.dataset.robot import Robot

TIME = frozenset({"time", "timestamp", "t", "zeit", "clock"})
POSITION = frozenset(
    {"position", "positions", "pos", "q", "qm", "qs", "angle", "ang", "theta", "enc", "encoder", "joint", "x"}
    | {"winkel", "stellung", "angulo", "posicion", "path", "stroke", "travel", "weg", "hub", "course"}
)
CURRENT = frozenset(
    {"current", "currents", "cur", "curr", "i", "iq", "amp", "amps", "effort", "torque", "tau", "vir", "u"}
    | {"strom", "drehmoment", "courant", "couple", "corriente"}
)
PLACES, DRIVES = ("angle", "length"), ("current", "voltage", "torque", "force")
"""Quantities that positions and currents may be."""


def guesses(
    names: Sequence[str],
    robot: Robot,
    stated: Mapping[str, str] = {},
    values: Mapping[str, np.ndarray] = {},
) -> dict[str, dict[str, str]]:
    """Needed column -> {column, unit, why} for those that names or units identify; a person confirms them.

    stated: units by column as the log gives them; they identify columns with names in an unknown language. values: of
    the columns (N,); with the joint's range, they distinguish a path in mm from one in m.
    why is "name" if the log's name contains the joint's, "order" if names are assigned in their order, "unit" if
    no other column has a unit of this joint's kind, "rest" if only this joint and this column remain, "alike" if a
    current's name shares a word with that of its joint's position, and "range" if the values determine the unit.
    """
    proposed: dict[str, tuple[str, str]] = {}
    time = next((name for name in names if (words := _words(name)) and words[0] in TIME), None)
    if time is not None:
        proposed["time"] = time, "name"
    for kind, spoken, measured in (("position", POSITION, PLACES), ("current", CURRENT, DRIVES)):
        free = [name for name in names if name != time and spoken & set(_words(name))]
        if not free:
            free = [name for name in names if name != time and _measures(name, stated) in measured]
        named, why = _by_name(free, robot.driven), "name"
        numbered = [name for name in free if re.search(r"\d", _stem(name)) or len(robot.driven) == 1]
        in_order = not robot.redundant and len(numbered) == len(robot.driven)
        if not named and in_order:
            named, why = dict(zip(robot.driven, sorted(numbered, key=_number), strict=True)), "order"
        proposed |= {f"{kind}.{joint}": (name, why) for joint, name in named.items()}
    facts = {f"position.{fact.name}": fact for fact in joint_facts(robot)}
    taken = {name for name, _ in proposed.values()}
    rest = {name: values.get(name) for name in names if name not in taken}
    open_ = {target: fact for target, fact in facts.items() if target not in proposed}
    proposed |= _by_unit(rest, open_, robot, stated)
    currents = [name for name in rest if _measures(name, stated) in DRIVES]
    proposed |= _alike(currents, {target: name for target, (name, _) in proposed.items()}, robot.driven)
    taken = {name for name, _ in proposed.values()}
    proposed |= _in_order([name for name in names if name not in taken], proposed, robot, stated)
    guessed = {}
    for target, (name, why) in proposed.items():
        unit = unit_in(name, units_of(target, robot))
        by_range = "" if unit or name in stated else _by_range(facts.get(target), values.get(name))
        guessed[target] = {"column": name, "unit": unit or by_range, "why": "range" if by_range else why}
    return guessed


def _by_unit(
    free: Mapping[str, np.ndarray | None],
    open_: Mapping[str, JointFacts],
    robot: Robot,
    stated: Mapping[str, str],
) -> dict[str, tuple[str, str]]:
    """Positions that no name identifies: the only joint that measures a length (or an angle) gets the only column
    that does, and the last joint gets the last position without a unit.

    free: unassigned columns with their values. Of several columns, those within the joint's range count.
    """
    chosen = {}
    for measured in PLACES:
        joints = [target for target in open_ if measured_by(target, robot) == measured]
        columns = [name for name in free if _measures(name, stated) == measured]
        if len(joints) == 1 and len(columns) > 1:
            columns = [name for name in columns if _within(open_[joints[0]], free[name], _unit(name, stated))]
        if len(joints) == len(columns) == 1:
            chosen[joints[0]] = columns[0], "unit"
    last = [target for target in open_ if target not in chosen]
    unmeasured = [name for name in free if POSITION & set(_words(name)) and not _measures(name, stated)]
    if len(last) == len(unmeasured) == 1:
        chosen[last[0]] = unmeasured[0], "rest"
    return chosen


def _alike(
    currents: Sequence[str], proposed: Mapping[str, str], joints: Sequence[str]
) -> dict[str, tuple[str, str]]:
    """Currents that no name identifies: each goes to the joint whose position alone shares a word with its name."""
    places = {joint: proposed[f"position.{joint}"] for joint in joints if f"position.{joint}" in proposed}
    chosen = {}
    for joint, place in places.items():
        others = {word for other in places.values() if other != place for word in _words(other)}
        words = {*_words(place)} - others
        alike = [name for name in currents if words & {*_words(name)}]
        if len(alike) == 1 and f"current.{joint}" not in proposed:
            chosen[f"current.{joint}"] = alike[0], "alike"
    return chosen if len({name for name, _ in chosen.values()}) == len(chosen) else {}


def _in_order(
    free: Sequence[str], proposed: Mapping[str, object], robot: Robot, stated: Mapping[str, str]
) -> dict[str, tuple[str, str]]:
    """Columns in their order for the joints in theirs, where exactly as many measure what these joints need.

    None for joints of which one has a column, for names of which one contains a joint's, and for currents of both
    hinges and slides.
    """
    chosen: dict[str, tuple[str, str]] = {}
    turns = {units_of_gain(actuator.gain_unit).rotates for actuator in robot.motors}
    for kind, spoken, quantities in (("position", POSITION, PLACES), ("current", CURRENT, DRIVES)):
        if robot.redundant or (kind == "current" and len(turns) > 1):
            continue
        for measured in quantities:
            joints = [joint for joint in robot.driven if measured_by(f"{kind}.{joint}", robot) == measured]
            of = {name: _measures(name, stated) for name in free}
            columns = [
                name for name in free if of[name] == measured or (not of[name] and spoken & {*_words(name)})
            ]
            named = any(set(_parts(joint)) <= set(_parts(name)) for joint in robot.driven for name in columns)
            assigned = any(f"{kind}.{joint}" in proposed for joint in joints)
            if len(columns) == len(joints) and not named and not assigned:
                for joint, name in zip(joints, columns, strict=True):
                    chosen[f"{kind}.{joint}"] = name, "order"
    return chosen


def _within(joint: JointFacts, values: np.ndarray | None, unit: str | None) -> bool:
    """Whether values in a unit lie in a joint's range; False if any of the three is unknown."""
    if values is None or unit is None or joint.lower is None or joint.upper is None:
        return False
    known = values[np.isfinite(values)] * UNITS[unit].factor
    return bool(known.size and joint.lower <= known.min() and known.max() <= joint.upper)


def _by_range(joint: JointFacts | None, values: np.ndarray | None) -> str:
    """The unit in which a path fits the range of its slide; "" if it fits in m, or the slide has no range.

    Units of angles are not guessed: the factor of 57 between degrees and radians is less conclusive than a thousand.
    """
    if joint is None or joint.kind != "slide" or joint.lower is None or values is None:
        return ""
    known = values[np.isfinite(values)]
    fault = position_units(Channel(known, 1.0, joint)) if known.size else None
    remedy = None if fault is None else fault.remedy
    return "" if remedy is None else IN_UNIT[remedy][1]


def _unit(name: str, stated: Mapping[str, str]) -> str | None:
    """A column's unit, stated or in its name; None if there is none."""
    match = LAST.match(name)
    return stated.get(name) or (name_of(match.group(2)) if match else None)


def _measures(name: str, stated: Mapping[str, str]) -> str:
    """The quantity of a column's unit; "" if it has none."""
    unit = _unit(name, stated)
    return UNITS[unit].of if unit else ""


def _by_name(names: Sequence[str], joints: Sequence[str]) -> dict[str, str]:
    """Joint -> the only name that contains all words and numbers of the joint's name."""
    by_joint = {}
    for joint in joints:
        wanted = set(_parts(joint))
        holding = [name for name in names if wanted <= set(_parts(_stem(name)))]
        if len(holding) == 1:
            by_joint[joint] = holding[0]
    return by_joint if len(set(by_joint.values())) == len(by_joint) else {}


def _stem(name: str) -> str:
    """A name without the unit that it ends in: t_ms -> t."""
    match = LAST.match(name)
    return match.group(1) if match and name_of(match.group(2)) else name


def _parts(name: str) -> list[str]:
    return [part.lower() for part in re.findall(r"[^\W\d_]+|\d+", name)]


def _words(name: str) -> list[str]:
    return [part for part in _parts(_stem(name)) if not part.isdigit()]


def _number(name: str) -> tuple[int, ...]:
    return tuple(int(part) for part in _parts(_stem(name)) if part.isdigit())
