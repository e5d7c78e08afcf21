"""Cures for faults of a log, as options of `bench import`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.basics.files.recording_fault import IN_UNIT, RecordingFaultError, Remedy
from bench.dataset.logs.columns import GROUPS, Columns
from bench.dataset.logs.units import UNITS, bracketed, measured_by, unit_in, unit_named, units_of
from bench.dataset.robot import Robot

CUTS: Mapping[Remedy, str] = {
    Remedy.CUT_AT_GAPS: "cut the log there",
    Remedy.CUT_WHERE_BACK: "cut the log there",
    Remedy.LEAVE_ROWS_OUT: "omit such rows and split the log there",
}
"""The effect of --split-gaps on each fault."""


@dataclass(frozen=True)
class UnitCures:
    """What is known about the units of a log's columns: their names, the given scales, and all faults of the log."""

    robot: Robot
    columns: Columns
    scale: Mapping[str, float | str]
    faults: Sequence[RecordingFaultError]

    def cure(self, fault: RecordingFaultError, remedy: Remedy) -> str:
        """The cure for a column that appears to be in another unit; never one that would convert it twice."""
        group, unit = IN_UNIT[remedy]
        column = fault.column or group
        stated = self.columns.stated
        if column in stated:
            return f"it is turned from {stated[column]} already, as the log says: is this its column?"
        key = column if column in self.scale else group
        if key in self.scale:
            return self._other_scale(key, unit)
        source = self.columns.sources.get(column, "")
        foreign = bracketed(source)
        if foreign and unit_named(foreign) is None:
            return f"its name says {foreign!r}, which is not a known unit: add --scale {column}=FACTOR"
        named = unit_in(source, units_of(column, self.robot))
        if named and UNITS[named].factor != 1.0:
            return f"its name says {named}: add --scale {column}={named}"
        return self._by_joint(column, group, unit, remedy)

    def longer(self, fault: RecordingFaultError) -> str:
        """The cure for time steps that are too short in the stated or given unit."""
        column = fault.column
        stated = self.columns.stated.get(column)
        given = self.scale.get(column)
        if given is not None:
            return f"give another unit than --scale {column}={_number(given)}, for example {column}=ms"
        if stated is not None:
            return f"it is turned from {stated}, as the log says: if that is wrong, add --scale {column}=ms"
        return f"add --scale {column}=min if it is in minutes"

    def _by_joint(self, column: str, group: str, unit: str, remedy: Remedy) -> str:
        """The scale option for one joint, or for all if all joints of that kind have the same fault."""
        alike = {fault.column for fault in self.faults if fault.remedy is remedy}
        of = UNITS[unit].of
        all_of_it = [f"{group}.{joint}" for joint in self.robot.driven]
        others = {name for name in all_of_it if group != "current" and measured_by(name, self.robot) != of}
        if group not in GROUPS or alike >= {*all_of_it} - others:
            return f"add --scale {group}={unit}"
        for other in all_of_it:
            if other != column and unit_named(self.columns.stated.get(other, "")) == UNITS[unit]:
                si = next(name for name, known in UNITS.items() if (known.factor, known.of) == (1.0, of))
                return (
                    f"the log says that {other} is in {unit}: if the units are exchanged, add --scale {column}={unit} "
                    f"--scale {other}={si}"
                )
        return f"add --scale {column}={unit}"

    def _other_scale(self, key: str, unit: str) -> str:
        given = self.scale[key]
        before = unit_named(given) if isinstance(given, str) else None
        factor = (before.factor if before is not None else float(given)) * UNITS[unit].factor
        known = (alike.factor for alike in UNITS.values() if alike.of == UNITS[unit].of)
        if not any(math.isclose(factor, unit_factor, rel_tol=1e-9) for unit_factor in known):
            return f"it is turned by --scale {key}={_number(given)} already: is this its column?"
        return f"give --scale {key}={factor:.12g} in place of --scale {key}={_number(given)}"


def with_cure(fault: RecordingFaultError, cures: UnitCures) -> str:
    """A fault's message for an import: its cure is an option rather than a key of dataset.toml."""
    if fault.remedy in (Remedy.REMOVE_ROWS, Remedy.OTHER_COLUMN):
        return f"{fault.said}{fault.advice}"
    said = fault.said if fault.check is None else f"{fault.said} (--accept {fault.check} if that is meant)"
    if fault.remedy is not None and fault.remedy in CUTS:
        return f"{said}; add --split-gaps to {CUTS[fault.remedy]}"
    if fault.remedy is Remedy.FROM_LONGER_UNIT:
        return f"{said}; {cures.longer(fault)}"
    if fault.remedy is None or fault.remedy not in IN_UNIT:
        return said
    return f"{said}; {cures.cure(fault, fault.remedy)}"


def once_a_row(faults: Sequence[RecordingFaultError]) -> list[RecordingFaultError]:
    """The same faults, with those of one row in several columns merged into one."""
    kept: dict[tuple[str, str], RecordingFaultError] = {}
    columns: dict[tuple[str, str], list[str]] = {}
    for fault in faults:
        of_rows = fault.remedy in (Remedy.LEAVE_ROWS_OUT, Remedy.REMOVE_ROWS)
        key = ("" if of_rows else fault.column, fault.said.partition(", line ")[2] or fault.said)
        kept.setdefault(key, fault)
        columns.setdefault(key, []).append(fault.column)
    return [
        fault
        if len(columns[key]) == 1
        else RecordingFaultError(
            f"{fault.said}, likewise in {', '.join(columns[key][1:])}",
            fault.advice,
            fault.remedy,
            fault.check,
            column=fault.column,
        )
        for key, fault in kept.items()
    ]


def _number(given: float | str) -> str:
    return given if isinstance(given, str) else f"{given:.12g}"
