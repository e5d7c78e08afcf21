"""The user's request for an experiment: limits, payload, sensors, as TOML with a value for all joints or one each."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from bench.basics.errors import BenchError, meant
from bench.basics.files.toml_input import UserTable, first_mistake, read_toml
from bench.basics.joint_units import units_of_gain
from bench.basics.sentence import and_list
from bench.dataset.payload import Payload, payload_fault
from bench.dataset.robot import Robot
from bench.scenario.tables import (
    DeclaredPayload,
    NotNegativePerJoint,
    Number,
    Positive,
    PositivePerJoint,
    Vector3,
)

PAYLOAD = "payload"  # its name in written files
PER: Mapping[str, str] = {"velocity": "s", "acceleration": "s2"}
"""Divisor of rad or m in each unit."""


class Box(UserTable):
    """[[workspace]]: a box along the world's axes that the tool stays inside or outside of."""

    keep: Literal["inside", "outside"] = "inside"
    low: Vector3
    """m."""
    high: Vector3


class ExpectedSensors(UserTable):
    """[sensors]: expected noise of the controller's log."""

    current_noise: NotNegativePerJoint | None = None
    """Standard deviation, drive unit; omitted, 1 % of the RMS current of each recording."""
    current_noise_ratio: Positive = 0.01
    encoder_resolution: NotNegativePerJoint = 0.0
    """A step, rad or m."""


class ExperimentTable(UserTable):
    """The file of `bench excite ROBOT --limits FILE`; options of the command go before it."""

    duration: Positive = 20.0
    """Of each motion, s."""
    rate: Positive = 1000.0
    """Of the controller's table and log, Hz."""
    harmonics: int = Field(default=8, ge=1, le=50)
    base_frequency: Positive | None = None
    ramp: Positive = 1.0
    velocity: PositivePerJoint | None = None
    acceleration: PositivePerJoint | None = None
    current: PositivePerJoint | None = None
    """Largest, drive unit, by the robot's nominal gains."""
    torque: PositivePerJoint | None = None
    position: Mapping[str, tuple[Number, Number]] = {}
    """Joint = [low, high], rad or m, inside the joint ranges of the robot."""
    amplification: Positive | None = None
    """Largest passive speed for active speed; omitted, three times that of the home pose."""
    workspace: tuple[Box, ...] = ()
    payload: DeclaredPayload | None = None
    sensors: ExpectedSensors = ExpectedSensors()


def joint_values(key: str, value: float | Mapping[str, float], joints: Sequence[str]) -> np.ndarray:
    """A number for all joints, or one for each by name, (n,); BenchError for unknown joints."""
    if not isinstance(value, Mapping):
        return np.full(len(joints), float(value))
    for name in value:
        check_joint(key, name, joints)
    for joint in joints:
        if joint not in value:
            raise BenchError(f"{key}: joint {joint!r} is missing")
    return np.array([value[joint] for joint in joints], dtype=float)


def assumed_units(key: str, value: float | Mapping[str, float], robot: Robot) -> list[str]:
    """The assumption on speeds or accelerations that one number is in the unit of slides, or of hinges and slides."""
    turning, sliding = f"rad/{PER[key]}", f"m/{PER[key]}"
    units = _units(key, robot).values()
    if isinstance(value, Mapping) or sliding not in units:
        return []
    said = f"{turning} at hinges, {sliding} at slides" if turning in units else sliding
    return [f"{key} {value:g}: {said}"]


def _units(key: str, robot: Robot) -> dict[str, str]:
    """The unit of speeds or accelerations by joint."""
    return {
        actuator.joint: f"{units_of_gain(actuator.gain_unit).position}/{PER[key]}"
        for actuator in robot.actuators
    }


def with_units(key: str, values: np.ndarray, robot: Robot) -> str:
    """Speeds or accelerations (n,) of the joints with their units: one number if they are alike."""
    units = _units(key, robot)
    said = {joint: f"{value:.3g} {units[joint]}" for joint, value in zip(units, values, strict=True)}
    if len(set(said.values())) == 1:
        return next(iter(said.values()))
    return ", ".join(f"{joint} {text}" for joint, text in said.items())


def assumed_ranges(robot: Robot, joints: Sequence[str], low: np.ndarray, high: np.ndarray) -> str:
    """The assumed ranges of joints that have none in the MJCF, low and high (n,)."""
    ranges, cures = [], []
    parts = {
        "joint": "`range` at each joint in the MJCF",
        "tendon": "`range` at each tendon in the MJCF",
        "motor": "`position` in the file of --limits",
    }
    for actuator, least, most in zip(robot.actuators, low, high, strict=True):
        if actuator.joint in joints:
            cures.append(parts[actuator.drives])
            unit = units_of_gain(actuator.gain_unit).position
            ranges.append(f"{actuator.joint} {least:.3g} to {most:.3g} {unit}")
    return f"range: {', '.join(ranges)} (write {and_list(list(dict.fromkeys(cures)))})"


def by_unit(key: str, given: Sequence[tuple[float, str]], robot: Robot) -> float | dict[str, float] | None:
    """Speeds or accelerations from the command line: None, a number, or one for each joint by its unit.

    given: numbers with units, "" for none. Raises BenchError for numbers without a joint, and joints without a number.
    """
    if not given:
        return None
    numbers = {unit: value for value, unit in given}
    if set(numbers) == {""}:
        return numbers[""]
    units = _units(key, robot)
    for unit, value in numbers.items():
        if unit not in units.values():
            lacking = next((other for other in units.values() if other not in numbers), "")
            if not unit and lacking:
                raise BenchError(f"{key}: {value:g} has no unit: write {value:g}{lacking}")
            what = f"in {unit}" if unit else "without a unit, next to others with one"
            raise BenchError(f"{key}: {value:g} {what}: no joint of {robot.name!r} takes it")
    for joint, unit in units.items():
        if unit not in numbers:
            raise BenchError(f"{key}: joint {joint!r} is in {unit}: add --{key} NUMBER{unit}")
    return {joint: numbers[unit] for joint, unit in units.items()}


def check_joint(key: str, name: str, joints: Sequence[str]) -> None:
    """Raise BenchError unless a joint of this name has a motor."""
    if name not in joints:
        raise BenchError(f"{key}: no actuated joint {name!r}; {meant(name, joints)}")


def asked_payload(robot: Robot, table: DeclaredPayload | None) -> Payload | None:
    """The payload of the loaded motion, of known mass; None without one."""
    if table is None:
        return None
    if robot.tool_site is None:
        raise BenchError(f"payload: the robot {robot.name!r} has no [tool] site to fix it at")
    if table.mass is None:
        raise BenchError("payload: its mass is missing: it gives the scale of the drive gains")
    if table.inertia is not None and table.center_of_mass is None:
        raise BenchError("payload: an inertia needs the center_of_mass about which it is")
    payload = Payload(
        PAYLOAD,
        table.mass,
        None if table.center_of_mass is None else np.array(table.center_of_mass),
        None if table.inertia is None else np.array(table.inertia),
    )
    fault = payload_fault(payload)
    if fault is not None:
        raise BenchError(f"payload.{fault[0]}: {fault[1]}")
    return payload


def asked_table(file: Path | None, given: Mapping[str, Any], robot: Robot) -> ExperimentTable:
    """The file's table, or an empty one, with values of the command line in place of its keys.

    `payload_mass` is the mass of the payload; `velocity` and `acceleration` are pairs of a number and its unit.
    Raises BenchError in one line.
    """
    table = ExperimentTable() if file is None else read_toml(file, ExperimentTable)
    given = {**given, **{key: by_unit(key, given.get(key, ()), robot) for key in PER}}
    changes = {key: value for key, value in given.items() if value is not None}
    mass = changes.pop("payload_mass", None)
    content = {**table.model_dump(exclude_unset=True), **changes}
    if mass is not None:
        content["payload"] = {**(content.get("payload") or {}), "mass": mass}
    try:
        return ExperimentTable.model_validate(content)
    except ValidationError as error:
        raise BenchError(f"limits: {first_mistake(error)}") from error
