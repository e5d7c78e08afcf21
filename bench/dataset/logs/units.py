"""Units of logs, and the factors that convert them to SI."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi

from bench.basics.errors import BenchError
from bench.basics.joint_units import drive_unit, units_of_gain
from bench.dataset.robot import Robot

TURN = 2.0 * pi


@dataclass(frozen=True)
class Unit:
    """factor: to SI; of: the quantity that it measures."""

    factor: float
    of: str


UNITS: Mapping[str, Unit] = {
    "s": Unit(1.0, "time"),
    "ms": Unit(1e-3, "time"),
    "us": Unit(1e-6, "time"),
    "ns": Unit(1e-9, "time"),
    "min": Unit(60.0, "time"),
    "rad": Unit(1.0, "angle"),
    "mrad": Unit(1e-3, "angle"),
    "deg": Unit(TURN / 360.0, "angle"),
    "turn": Unit(TURN, "angle"),
    "rad/s": Unit(1.0, "angular velocity"),
    "deg/s": Unit(TURN / 360.0, "angular velocity"),
    "rpm": Unit(TURN / 60.0, "angular velocity"),
    "m": Unit(1.0, "length"),
    "cm": Unit(1e-2, "length"),
    "mm": Unit(1e-3, "length"),
    "um": Unit(1e-6, "length"),
    "m/s": Unit(1.0, "velocity"),
    "cm/s": Unit(1e-2, "velocity"),
    "mm/s": Unit(1e-3, "velocity"),
    "A": Unit(1.0, "current"),
    "mA": Unit(1e-3, "current"),
    "V": Unit(1.0, "voltage"),
    "mV": Unit(1e-3, "voltage"),
    "N*m": Unit(1.0, "torque"),
    "mN*m": Unit(1e-3, "torque"),
    "N": Unit(1.0, "force"),
    "mN": Unit(1e-3, "force"),
    "kN": Unit(1e3, "force"),
}

_SPELLINGS = {
    "°": "deg",
    "°/s": "deg/s",
    "degree": "deg",
    "degrees": "deg",
    "Grad": "deg",
    "sec": "s",
    "rev": "turn",
    "Nm": "N*m",
    "N·m": "N*m",
    "N.m": "N*m",
    "N m": "N*m",
    "mNm": "mN*m",
}
_OF_CURRENT = {"A": "current", "V": "voltage", "(N*m)": "torque", "N": "force"}


def unit_named(text: str) -> Unit | None:
    """The unit that a text spells, with any brackets and either micro sign; None if it spells none."""
    plain = text.strip().strip("[]()").strip().replace("µ", "u").replace("μ", "u")
    return UNITS.get(_SPELLINGS.get(plain, plain))


def bracketed(name: str) -> str:
    """The text in square brackets at the end of a name, as in "q1 [deg]"; "" if there are none."""
    match = re.search(r"\[([^\]]+)\]$", name)
    return match.group(1) if match else ""


def measured_by(column: str, robot: Robot) -> str | None:
    """The quantity of a recording's column (time, angle, current ...); None for columns that are kept for plots."""
    if column == "time":
        return "time"
    kind, _, joint = column.partition(".")
    unit = next((motor.gain_unit for motor in robot.motors if motor.joint == joint), None)
    if unit is None:
        return None
    place, rate = ("angle", "angular velocity") if units_of_gain(unit).rotates else ("length", "velocity")
    return {"current": _OF_CURRENT[drive_unit(unit)], "position": place, "velocity": rate}.get(kind)


def unit_of_velocity(scale: float, rotates: bool, near: float) -> str:
    """The unit in which a velocity is `scale` times that in SI, within a relative difference `near`; "" if none."""
    of = "angular velocity" if rotates else "velocity"
    known = {name: unit.factor for name, unit in UNITS.items() if unit.of == of and unit.factor != 1.0}
    return next((name for name, factor in known.items() if abs(scale * factor - 1.0) < near), "")


def factor_of(where: str, unit: str, column: str, robot: Robot) -> float | None:
    """The factor for a column whose log states its unit; None for an unknown unit of a column that is kept for plots.

    Raises BenchError that starts with `where` for an unknown unit of another column, or a unit of another quantity.
    """
    known, needed = unit_named(unit), measured_by(column, robot)
    if known is None:
        if needed is None:
            return None
        raise BenchError(f"{where} is in {unit!r}, which is not a known unit: add --scale {column}=FACTOR")
    if needed is not None and known.of != needed:
        said = f"{where} is in {unit!r}, {_a(known.of)}, and {column} must be {_a(needed)}"
        if known.of in ("torque", "force") and column.startswith("current."):
            said += ' (a log of torques? then gain_unit = "1" in robot.toml)'
        raise BenchError(said)
    return known.factor


def _a(noun: str) -> str:
    return f"an {noun}" if noun.startswith("a") else f"a {noun}"


LAST = re.compile(r"^(.*?)[\s_.\[(]+([^\s_.\[\]()]+)[\])]?$")


def unit_in(name: str, possible: Sequence[str]) -> str:
    """The unit that a name ends in, if it is possible, else "": q_left[deg] -> deg."""
    match = LAST.match(name)
    unit = name_of(match.group(2)) if match else None
    return unit if unit is not None and unit in possible else ""


def name_of(text: str) -> str | None:
    """The name of the unit that a text spells; None if it spells none."""
    unit = unit_named(text)
    return next((name for name, known in UNITS.items() if known == unit), None)


def stated_units(stated: Mapping[str, str]) -> dict[str, str]:
    """The units that a log states, by column, as names in `UNITS`; unknown ones are omitted."""
    return {column: unit for column, text in stated.items() if (unit := name_of(text))}


def units_of(column: str, robot: Robot) -> list[str]:
    """The units that a recording's column may be in, SI first."""
    names = [name for name, unit in UNITS.items() if unit.of == measured_by(column, robot)]
    return sorted(names, key=lambda name: UNITS[name].factor != 1.0) or ["1"]
