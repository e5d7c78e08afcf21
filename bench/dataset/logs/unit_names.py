"""Units that stand in the names of a log's columns: q_left[deg], t_ms."""

import re
from collections.abc import Sequence

from bench.dataset.logs.units import UNITS, measured_by, unit_named
from bench.dataset.robot import Robot

LAST = re.compile(r"^(.*?)[\s_.\[(]+([^\s_.\[\]()]+)[\])]?$")


def unit_in(name: str, possible: Sequence[str]) -> str:
    """The unit that a name ends in, if it is one of these; "" for none: q_left[deg] -> deg."""
    match = LAST.match(name)
    unit = name_of(match.group(2)) if match else None
    return unit if unit is not None and unit in possible else ""


def name_of(text: str) -> str | None:
    """The name of the unit that a text spells; None for others."""
    unit = unit_named(text)
    return next((name for name, known in UNITS.items() if known == unit), None)


def units_of(column: str, robot: Robot) -> list[str]:
    """The units that a recording's column may be in, SI first."""
    names = [name for name, unit in UNITS.items() if unit.of == measured_by(column, robot)]
    return sorted(names, key=lambda name: UNITS[name].factor != 1.0) or ["1"]
