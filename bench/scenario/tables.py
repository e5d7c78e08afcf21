"""The tables of a scenario file: keys, units and defaults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from bench.basics.files.toml_input import UserTable
from bench.dataset.names import Use

FILE_NAME = r"^[A-Za-z0-9][A-Za-z0-9_.-]*$"


def _at_most_one(table: UserTable, keys: Sequence[str]) -> None:
    given = [key for key in keys if getattr(table, key)]  # 0 switches off a value of the base scenario
    if len(given) > 1:
        raise ValueError(f"only one of {' and '.join(given)} can be given")


def _number_or_table(value: Any) -> Any:
    values = value.values() if isinstance(value, Mapping) else [value]
    if not values or not all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
        raise ValueError("should be a number, or a table with one number a joint")
    if not np.isfinite(list(values)).all():
        raise ValueError("should be finite")
    return value


def _positive(value: float | Mapping[str, float]) -> float | Mapping[str, float]:
    if min(value.values() if isinstance(value, Mapping) else [value]) <= 0:
        raise ValueError("should be greater than 0")
    return value


def _not_negative(value: float | Mapping[str, float]) -> float | Mapping[str, float]:
    if min(value.values() if isinstance(value, Mapping) else [value]) < 0:
        raise ValueError("should be at least 0")
    return value


Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Vector3 = Annotated[tuple[Number, ...], Field(min_length=3, max_length=3)]
Vector6 = Annotated[tuple[Number, ...], Field(min_length=6, max_length=6)]
PerJoint = Annotated[float | dict[str, float], BeforeValidator(_number_or_table)]
"""One number for all actuated joints, or a table joint = number that names each of them."""
PositivePerJoint = Annotated[PerJoint, AfterValidator(_positive)]
NotNegativePerJoint = Annotated[PerJoint, AfterValidator(_not_negative)]


class Gains(UserTable):
    """[gains]: the true drive gains, given in one of three ways; by default the nominal ones."""

    true: PositivePerJoint | None = None
    """True gains, in the unit of the robot's gains."""
    error: PerJoint | None = None
    """true = nominal · (1 + error)."""
    error_within: Annotated[float, Field(gt=0, lt=1)] | None = None
    """The error of each joint is drawn uniformly from ± this, with the scenario's seed."""

    @model_validator(mode="after")
    def _one_way(self) -> Gains:
        _at_most_one(self, ("true", "error", "error_within"))
        return self


class DeclaredPayload(UserTable):
    """[payloads.NAME.declared]: values that the dataset declares for the payload; omitted ones are unknown."""

    mass: Positive | None = None
    center_of_mass: Vector3 | None = None
    inertia: Vector6 | None = None


class PayloadTable(UserTable):
    """[payloads.NAME]: the true rigid body at the tool site."""

    mass: Positive
    """kg."""
    center_of_mass: Vector3 = (0.0, 0.0, 0.0)
    """m, in the tool frame."""
    inertia: Vector6 = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """kg·m², Ixx Iyy Izz Ixy Ixz Iyz at the centre of mass, axes of the tool frame."""
    declared: DeclaredPayload | None = None
    """If omitted, the dataset declares the truth."""


class Design(UserTable):
    """A trajectory within limits: optimised for excitation with `optimise`, otherwise random."""

    optimise: bool = False
    seed: Annotated[int, Field(ge=0)] = 0
    harmonics: Annotated[int, Field(ge=1, le=50)] = 5
    base_frequency: Positive = 0.1
    duration: Positive = 20.0
    ramp: Positive = 1.0
    center: PerJoint | None = None
    """rad or m; default: the home pose."""
    span: PositivePerJoint = Field(default=...)
    """Largest deviation from the center, rad or m."""
    velocity_limit: PositivePerJoint = Field(default=...)
    acceleration_limit: PositivePerJoint | None = None


class RecordingTable(UserTable):
    """[[recordings]]: one motion, given by exactly one of trajectory, trajectory_file and design."""

    name: Annotated[str, Field(pattern=FILE_NAME)]
    use: Use
    payload: str | None = None
    trajectory: dict[str, Any] | None = None
    """The keys of a FourierTrajectory."""
    trajectory_file: str | None = None
    """A TOML or JSON file with these keys, relative to the scenario."""
    design: Design | None = None

    @model_validator(mode="after")
    def _one_trajectory(self) -> RecordingTable:
        ways = ("trajectory", "trajectory_file", "design")
        _at_most_one(self, ways)
        if not any(getattr(self, way) for way in ways):
            raise ValueError(f"one of {', '.join(ways)} must be given")
        return self


class Controller(UserTable):
    """[controller]: i = (kp (q_ref − q) + kv (q̇_ref − q̇) + feedforward) / nominal gain, for each joint.

    Either kp and kv are given, or a natural frequency and a damping ratio, from which they follow with the effective
    inertia at the joint in the home pose, loops closed, no payload.
    """

    natural_frequency: PositivePerJoint = 10.0
    """Hz."""
    damping: PositivePerJoint = 1.0
    kp: PositivePerJoint | None = None
    """N·m/rad or N/m."""
    kv: NotNegativePerJoint | None = None
    """N·m·s/rad or N·s/m."""
    feedforward: Literal["none", "acceleration"] = "none"
    """"acceleration": the inertia in the home pose times the reference acceleration."""
    tracking_limit: PositivePerJoint | None = None
    """A larger |q_ref − q| ends the simulation with an error, rad or m; default: 0.3 rad or 0.1 m."""

    declared: bool = False
    """Whether the dataset declares the control law, and the log contains the reference positions."""

    @model_validator(mode="after")
    def _one_tuning(self) -> Controller:
        if (self.kp is None) != (self.kv is None):
            raise ValueError("kp and kv must be given together")
        if self.kp is not None and {"natural_frequency", "damping"} & self.model_fields_set:
            raise ValueError("give either kp and kv, or natural_frequency and damping")
        return self


class Sensors(UserTable):
    """[sensors]: noise, quantisation and jitter between the true state and the log."""

    encoder_bits: Annotated[int, Field(ge=0, le=40)] = 0
    """Steps of 2π / 2^bits rad, for hinge joints; 0: continuous."""
    encoder_resolution: NotNegativePerJoint = 0.0
    """Size of an encoder step, rad or m; 0: continuous."""
    position_noise: NotNegativePerJoint = 0.0
    """Standard deviation before quantisation, rad or m."""
    current_noise: NotNegativePerJoint = 0.0
    """Standard deviation before quantisation, in the drive's unit."""
    current_noise_ratio: NotNegativePerJoint = 0.0
    """The same as a fraction of the RMS current of that joint in that recording."""
    current_resolution: NotNegativePerJoint = 0.0
    """Steps of the logged current reference, in the drive's unit."""
    time_jitter: NotNegative = 0.0
    """Standard deviation of the logged time stamps, s; the samples themselves are uniform in time."""

    @model_validator(mode="after")
    def _one_of_each(self) -> Sensors:
        _at_most_one(self, ("encoder_bits", "encoder_resolution"))
        _at_most_one(self, ("current_noise", "current_noise_ratio"))
        return self


class Filter(UserTable):
    """[filter]: settings of the identification; omitted ones are chosen from the data."""

    position_cutoff: Positive | None = None
    """Hz."""
    filter_order: Annotated[int, Field(ge=1)] | None = None
    decimation: Annotated[int, Field(ge=1)] | None = None


class Hidden(UserTable, extra="allow"):
    """[[hidden]]: an effect that the dataset does not declare; the other keys are its parameters."""

    effect: Annotated[str, Field(min_length=1)]
    joint: str | None = None
    """Omitted: all actuated joints, all passive joints, or the whole machine, by the effect."""
    file: str | None = None
    """A Python file with a user-defined effect of that name, absolute or relative to the scenario."""

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The parameters of the law, by name; checked when the machine is built."""
        return dict(self.__pydantic_extra__ or {})


class ScenarioTable(UserTable):
    """The keys of a scenario file, except for `base` and `design`, which are merged before."""

    robot: Annotated[str, Field(min_length=1)]
    """A built-in name or a path, absolute or relative to the scenario."""
    description: str = ""
    seed: Annotated[int, Field(ge=0, strict=True)] = 0
    step: Positive = 0.00025
    """Step of the simulation, s."""
    log_rate: Positive = 1000.0
    """Sampling rate of the log, Hz."""
    settle: NotNegative = 0.5
    """Time during which the controller holds the first pose before the log begins, s."""
    file_format: Literal["csv", "parquet"] = "csv"
    gains: Gains = Gains()
    payloads: Mapping[str, PayloadTable] = {}
    recordings: Annotated[tuple[RecordingTable, ...], Field(min_length=1)]
    controller: Controller = Controller()
    sensors: Sensors = Sensors()
    filter: Filter = Filter()
    hidden: tuple[Hidden, ...] = ()
    tolerances: Mapping[str, Positive] = {}
