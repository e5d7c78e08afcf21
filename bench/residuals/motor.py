"""Measured and modelled current of one motor in one recording, for examination."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.basics.joint_units import drive_unit, units_of_gain
from bench.dataset.recording import Recording
from bench.dataset.robot import Robot
from bench.identification.current_noise import noise_of_series
from bench.identification.result import CurrentSeries
from bench.residuals.bounds import ERROR_GRID
from bench.signals.settings import FilterSettings


@dataclass(frozen=True, eq=False, repr=False)
class MotorSeries:
    """The rows of one recording in which one motor moves, M of them, at the fit's rate.

    time s from the start of the recording; measured, modelled: current in the drive's unit; position, velocity,
    acceleration: rad or m and their rates, each (M,). row (M,): index among all rows, which shows the gaps while the
    joint is at rest. to_reversal (M,): rows to the nearest reversal, signed; reversal, after_standstill (M,): whether a
    row is next to one. noise: RMS of the current noise in the band of the fit, drive unit. rate: rows per second; band:
    the highest frequency in the fit, Hz.
    """

    joint: str
    recording: str
    use: str
    payload: str | None
    rate: float
    band: float
    noise: float
    time: np.ndarray
    row: np.ndarray
    measured: np.ndarray
    modelled: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    to_reversal: np.ndarray
    near_standstill: np.ndarray

    def __repr__(self) -> str:
        return f"<motor {self.joint} in {self.recording}: {len(self.time)} rows, {self.use}>"

    @property
    def error(self) -> np.ndarray:
        """Measured minus modelled current (M,), drive unit."""
        return self.measured - self.modelled

    @property
    def forwards(self) -> np.ndarray:
        """If the joint moves in its positive direction (M,)."""
        return self.velocity > 0

    @property
    def at_reversal(self) -> np.ndarray:
        """The rows next to a change of direction (M,)."""
        return np.abs(self.to_reversal) <= ERROR_GRID.near_reversal


@dataclass(frozen=True, eq=False, repr=False)
class Compared:
    """All motors in all recordings. units: of current, position by joint, as in ("A", "rad")."""

    robot: str
    joints: tuple[str, ...]
    units: dict[str, tuple[str, str]]
    series: tuple[MotorSeries, ...]

    def __repr__(self) -> str:
        recordings = ", ".join(dict.fromkeys(trace.recording for trace in self.series))
        return f"<motors {', '.join(self.joints)} of {self.robot} in {recordings}>"

    def of(self, joint: str) -> tuple[MotorSeries, ...]:
        """The recordings of one motor, without those in which it hardly moves."""
        enough = (trace for trace in self.series if len(trace.time) >= ERROR_GRID.rows)
        return tuple(trace for trace in enough if trace.joint == joint)


def compared(
    robot: Robot, recordings: Sequence[Recording], series: Sequence[CurrentSeries], settings: FilterSettings
) -> Compared:
    """Split currents by motor. recordings: as logged, for their noise; settings: filters that the series passed."""
    logged = {recording.name: recording for recording in recordings}
    units = {}
    for actuator in robot.actuators:
        unit = actuator.gain_unit
        units[actuator.joint] = (drive_unit(unit), units_of_gain(unit).position)
    motors = []
    for trace in series:
        noise = noise_of_series(logged[trace.name], settings, trace)
        band = settings.band(logged[trace.name].rate)
        motors += [_motor(trace, j, joint, float(noise[j]), band) for j, joint in enumerate(robot.joints)]
    return Compared(robot.name, tuple(robot.joints), units, tuple(motors))


def relative_noise(series: Sequence[MotorSeries]) -> float:
    """RMS of the noise over RMS of the measured current, all rows together."""
    noise = sum(trace.noise**2 * len(trace.time) for trace in series)
    measured = sum(float(trace.measured @ trace.measured) for trace in series)
    return float(np.sqrt(noise / measured)) if measured else 0.0


def relative_error_of(series: Sequence[MotorSeries]) -> float | None:
    """RMS of the error over RMS of the measured current, all rows together; None without any."""
    measured = sum(float(trace.measured @ trace.measured) for trace in series)
    error = sum(float(trace.error @ trace.error) for trace in series)
    return float(np.sqrt(error / measured)) if measured else None


def _motor(series: CurrentSeries, j: int, joint: str, noise: float, band: float) -> MotorSeries:
    moving = series.moving[:, j]
    row = np.flatnonzero(moving)
    velocity = series.velocity[:, j]
    still = _standstill(moving)
    steps = np.diff(series.time)
    return MotorSeries(
        joint=joint,
        recording=series.name,
        use=series.use,
        payload=series.payload,
        rate=float(1.0 / np.median(steps)) if len(steps) else 0.0,
        band=band,
        noise=noise,
        time=(series.time - series.time[0])[row] if len(row) else np.empty(0),
        row=row,
        measured=series.measured[row, j],
        modelled=series.modelled[row, j],
        position=series.position[row, j],
        velocity=velocity[row],
        acceleration=series.acceleration[row, j],
        to_reversal=_to_nearest(row, _reversals(velocity, moving)),
        near_standstill=np.abs(_to_nearest(row, still.astype(float))) <= ERROR_GRID.near_reversal + 1,
    )


def _standstill(moving: np.ndarray) -> np.ndarray:
    """Rows of stretches in which the joint is at rest for longer than a reversal."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], ~moving, [False])).astype(int)))
    ends = zip(edges[::2], edges[1::2], strict=True)
    stretches = [np.arange(a, b) for a, b in ends if b - a > ERROR_GRID.swift]
    return np.concatenate([np.empty(0, dtype=int), *stretches])


def _reversals(velocity: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Fractional row indices at which the joint reverses; it may rest for a few rows."""
    row = np.flatnonzero(moving)
    before, after = row[:-1], row[1:]
    turned = (velocity[before] * velocity[after] < 0) & (after - before <= ERROR_GRID.swift + 1)
    before, after = before[turned], after[turned]
    share = velocity[before] / (velocity[before] - velocity[after])
    return np.asarray(before + (after - before) * share, dtype=float)


def _to_nearest(row: np.ndarray, marks: np.ndarray) -> np.ndarray:
    """Rows from the nearest mark to each row, negative before it; infinite without marks."""
    if not len(marks):
        return np.full(len(row), np.inf)
    after = np.clip(np.searchsorted(marks, row), 0, len(marks) - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(np.abs(row - marks[before]) <= np.abs(row - marks[after]), before, after)
    return np.asarray(row - marks[nearest], dtype=float)
