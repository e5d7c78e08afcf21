"""An identified model, with all that is needed to trust it, to save it and to apply it to other recordings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from bench.dataset.robot_locked import LockedJoint
from bench.identification.decision import DecisionRule, deciding_by, rule_in_force
from bench.identification.finding import Finding, Unknown
from bench.identification.finding_words import note
from bench.identification.frame import data_frame, html_table
from bench.identification.standard_errors import Deviations, StdFrom
from bench.identification.tolerances import TOLERANCES, Tolerances, bounded_by, tolerances_in_force
from bench.signals.settings import FilterSettings

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Quantity:
    """A value with its standard deviation, both in `unit`; `std` is 0 where the value was given."""

    value: float
    std: float
    unit: str

    @property
    def relative_std(self) -> float:
        """Standard deviation as a share of the value's size."""
        return self.std / abs(self.value) if self.value else float("inf")

    @property
    def determined(self) -> bool:
        """Whether the data determine it: its deviation is finite, and not both vast and larger than the value."""
        return math.isfinite(self.std) and not (
            self.std >= TOLERANCES.findings.parameter_std and self.std > abs(self.value)
        )


@dataclass(frozen=True)
class DriveGain(Quantity):
    """An actuator's drive gain, with its nominal value."""

    nominal: float

    @property
    def determined(self) -> bool:
        """Likewise; a gain smaller than its standard error is not (it could have either sign), nor one of rounding."""
        least = max(self.std, TOLERANCES.rank.torque * abs(self.nominal))
        return super().determined and least <= abs(self.value)

    @property
    def fitted(self) -> bool:
        """Whether it was an unknown, rather than held at its nominal value."""
        return self.std > 0.0


@dataclass(frozen=True)
class Parameter(Quantity):
    """A base or payload parameter; `grouping` says which standard parameters it groups."""

    name: str
    grouping: str


@dataclass(frozen=True)
class ErrorSummary:
    """RMS(measured - modelled current) / RMS(measured current), at the rate and bandwidth of the fit."""

    identify: float | None
    validate: float | None
    by_actuator: Mapping[str, float]
    by_actuator_validate: Mapping[str, float]
    by_recording: Mapping[str, float]

    @property
    def reported(self) -> float | None:
        """The error of recordings that were not fitted; if there are none, of the fitted ones."""
        return self.identify if self.validate is None else self.validate


@dataclass(frozen=True)
class BandPoint:
    """The same model in one band, Hz, with the cut-off of positions, Hz: its errors, and values with their standard
    errors.
    """

    band: float
    position_cutoff: float
    error_identify: float | None
    error_validate: float | None
    values: Mapping[Unknown, tuple[float, float]]


@dataclass(frozen=True, repr=False)
class CurrentSeries:
    """Measured and modelled currents of a recording at the fit's rate: time (M,) s, others (M, n).

    moving: False where a joint is at rest; errors are not judged there. by_effect: the torque or force (M, n) that the
    motors supply for each effect of the model, N*m or N, filtered like the currents; NaN where a joint is at rest,
    since such rows are interpolated, not modelled. sharing (n, r): RMS by which a redundant motor's current reduces the
    others' modelled currents.
    """

    name: str
    use: str
    payload: str | None
    time: np.ndarray
    measured: np.ndarray
    modelled: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    moving: np.ndarray
    by_effect: Mapping[str, np.ndarray] = field(default_factory=dict)
    sharing: np.ndarray | None = None

    def __repr__(self) -> str:
        rows, motors = self.measured.shape
        return f"<currents of {self.name}: {rows} rows, {motors} motors, {self.use}>"

    @property
    def error(self) -> np.ndarray:
        """Measured minus modelled current (M, n)."""
        return self.measured - self.modelled


@dataclass(frozen=True)
class ModelledRecording:
    """The recording of a model's errors, without its currents."""

    name: str
    use: str
    payload: str | None


@dataclass(frozen=True, repr=False)
class Identification:
    """The answer of `identify`.

    gains_fitted is False where nothing fixes the scale: the gains are nominal, and all parameters scale with their
    error. If a payload fixes only some gains, the others are nominal, with no standard error. effect_parameters: effect
    -> place -> parameter, the place being a joint, or joint@recording for the value of one recording. covariance (P,
    P), its rows named by covariance_rows; those of given values and omitted parameters are zero. left_out: names of the
    base parameters without which the fit is as good, if only essential ones were requested. findings: what limits the
    answer. std_from: the source of standard deviations. redundant: the motors, last of the drive gains, whose currents
    are given and not modelled, since the motion determines only the sum of the powers. locked: joints that robot.toml
    holds. bandwidths: the same model in all bands that were tried, the widest first, with this one. rule, tolerances:
    the thresholds and numerical bounds of the answer.
    """

    robot: str
    robot_folder: str
    method: str
    effects: tuple[str, ...]
    drive_gains: Mapping[str, DriveGain]
    gains_fitted: bool
    parameters: tuple[Parameter, ...]
    effect_parameters: Mapping[str, Mapping[str, Mapping[str, Quantity]]]
    covariance: np.ndarray
    covariance_rows: tuple[Unknown, ...]
    rank: int
    unknowns: int
    condition: float
    scaled_condition: float
    error: ErrorSummary
    settings: FilterSettings
    deviations: Deviations
    recordings: tuple[CurrentSeries, ...]
    left_out: tuple[str, ...]
    findings: tuple[Finding, ...]
    std_from: StdFrom = "noise"
    redundant: tuple[str, ...] = ()
    locked: tuple[LockedJoint, ...] = ()
    bandwidths: tuple[BandPoint, ...] = ()
    rule: DecisionRule = field(default_factory=rule_in_force, repr=False)
    tolerances: Tolerances = field(default_factory=tolerances_in_force, repr=False)

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints whose currents are modelled, in the order of every array of a recording."""
        return tuple(joint for joint in self.drive_gains if joint not in self.redundant)

    @property
    def notes(self) -> tuple[str, ...]:
        """What limits the answer, in words."""
        with deciding_by(self.rule), bounded_by(self.tolerances):
            return tuple(map(note, self.findings))

    def __repr__(self) -> str:
        gains = ", ".join(
            f"{joint} {drive_gain.value:.4g} ± {drive_gain.std:.2g}"
            if drive_gain.determined
            else f"{joint} not determined"
            for joint, drive_gain in self.drive_gains.items()
        )
        unit = next((drive_gain.unit for drive_gain in self.drive_gains.values()), "")
        error = self.error.reported
        error_text = "" if error is None else f", error {100.0 * error:.3g} %"
        return f"<{self.robot} with {', '.join(self.effects) or 'rigid bodies only'}: {gains} {unit}{error_text}>"

    def _repr_html_(self) -> str:
        return html_table(repr(self)[1:-1], self.rows())

    def rows(self) -> list[dict[str, str | float]]:
        """Gains, parameters and effect parameters as a table: one row with kind, name, value, std and unit each."""
        named: list[tuple[str, str, Quantity]] = [
            ("drive gain", joint, gain) for joint, gain in self.drive_gains.items()
        ]
        named += [("parameter", parameter.name, parameter) for parameter in self.parameters]
        for effect, joints in self.effect_parameters.items():
            for joint, values in joints.items():
                named += [(effect, f"{name}({joint})", value) for name, value in values.items()]
        return [
            {"kind": kind, "name": name, "value": quantity.value, "std": quantity.std, "unit": quantity.unit}
            for kind, name, quantity in named
        ]

    def to_dataframe(self) -> pd.DataFrame:
        """As a data frame. Needs pandas."""
        rows = self.rows()
        return data_frame({name: [row[name] for row in rows] for name in rows[0]})


def relative_error(series: Sequence[CurrentSeries], motor: int | None = None) -> float | None:
    """RMS(measured - modelled) / RMS(measured) over recordings, for one motor or all; None without any."""
    if not series:
        return None
    chosen = slice(None) if motor is None else slice(motor, motor + 1)
    error = sum(float(((trace.error * trace.moving)[:, chosen] ** 2).sum()) for trace in series)
    measured = sum(float(((trace.measured * trace.moving)[:, chosen] ** 2).sum()) for trace in series)
    return float(np.sqrt(error / measured)) if measured else float("nan")


def error_summary(series: Sequence[CurrentSeries], joints: Sequence[str]) -> ErrorSummary:
    """Errors of all recordings by use, motor and recording."""
    fitted = [trace for trace in series if trace.use == "identify"]
    held_out = [trace for trace in series if trace.use == "validate"]

    def by_actuator(chosen: Sequence[CurrentSeries]) -> dict[str, float]:
        values = {joint: relative_error(chosen, j) for j, joint in enumerate(joints)}
        return {joint: value for joint, value in values.items() if value is not None}

    return ErrorSummary(
        identify=relative_error(fitted),
        validate=relative_error(held_out),
        by_actuator=by_actuator(fitted),
        by_actuator_validate=by_actuator(held_out),
        by_recording={
            trace.name: value for trace in series if (value := relative_error([trace])) is not None
        },
    )
