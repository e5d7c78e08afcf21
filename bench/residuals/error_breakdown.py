"""One motor's errors and the variables that they may depend on: the content of every chart of them, in any medium."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from bench.residuals.bounds import ERROR_GRID
from bench.residuals.motor import Compared, MotorSeries, relative_error_of, relative_noise
from bench.residuals.opposing_motion import Opposing, by_load, over_warm_up
from bench.residuals.profile import Profile, Variable, binned, profile, values_of
from bench.residuals.regions import OF_DATA, regions, shares

Direction = Literal["forwards", "backwards"]


@dataclass(frozen=True, eq=False)
class Branch:
    """Errors in one direction of motion: bins of all rows, and the rows: x, error (K,), drive unit."""

    direction: Direction
    bins: Profile
    x: np.ndarray
    error: np.ndarray


@dataclass(frozen=True, eq=False)
class ErrorBreakdown:
    """The errors of one motor in all recordings together. current, unit: of its current and position, as "A", "rad"."""

    joint: str
    current: str
    unit: str
    series: tuple[MotorSeries, ...]

    @cached_property
    def errors(self) -> np.ndarray:
        """Of all rows, one recording after the other, drive unit."""
        return np.concatenate([trace.error for trace in self.series])

    @cached_property
    def noise(self) -> float:
        """RMS of the current's noise in the band of the fit, drive unit."""
        rows = [len(trace.time) for trace in self.series]
        return float(np.sqrt(np.average([trace.noise**2 for trace in self.series], weights=rows)))

    @property
    def axes(self) -> Mapping[Variable, tuple[str, str]]:
        """Variables against which the error is drawn, in words, with units."""
        return {
            "time": ("time from the start of the recording", "s"),
            "position": ("position", self.unit),
            "velocity": ("velocity", f"{self.unit}/s"),
            "acceleration": ("acceleration", f"{self.unit}/s²"),
            "current": ("modelled current", self.current),
        }

    def against(self, variable: Variable, bins: int) -> tuple[Branch, ...]:
        """Against a variable, in bins with equally many rows, by direction."""
        x = np.concatenate([values_of(trace, variable) for trace in self.series])
        forwards = np.concatenate([trace.forwards for trace in self.series])
        return tuple(
            Branch(direction, profile(x[way], self.errors[way], bins), x[way], self.errors[way])
            for direction, way in _ways(forwards, ~forwards)
        )

    @cached_property
    def around_reversals(self) -> tuple[Branch, ...]:
        """Before and after a change of direction, by the direction afterwards; x in s."""
        rate = self.series[0].rate or 1.0
        rows = np.concatenate([trace.to_reversal for trace in self.series])
        # a row before a reversal to forwards moves backwards
        into = np.concatenate([trace.forwards ^ (trace.to_reversal < 0) for trace in self.series])
        near = np.abs(rows) <= ERROR_GRID.around_reversal
        edges = np.arange(-ERROR_GRID.around_reversal, ERROR_GRID.around_reversal + 1.0) / rate
        x, error = rows / rate, self.errors
        return tuple(
            Branch(direction, binned(x[way], error[way], edges), x[way], error[way])
            for direction, way in _ways(near & into, near & ~into)
        )

    @cached_property
    def by_recording(self) -> tuple[tuple[float, float], ...]:
        """Of each of `series`, RMS of the error and of the current noise over that of the measured current."""
        return tuple((relative_error_of([trace]) or 0.0, relative_noise([trace])) for trace in self.series)

    @cached_property
    def opposing(self) -> tuple[tuple[str, Opposing], ...]:
        """The mean error that opposes the motion, early and late and by payload, if any."""
        parts = [*over_warm_up(self.series), *by_load(self.series)]
        names = ["first third", "last third", *(opposing.part for opposing in parts[2:])]
        return tuple(
            (name, opposing) for name, opposing in zip(names, parts, strict=True) if np.isfinite(opposing.std)
        )

    @cached_property
    def shares(self) -> Mapping[str, tuple[float, float]]:
        """By part of the motion, its shares in the squared error and in time."""
        parts = regions(self.series, self.unit, self.current)
        return {
            part.where.name: shares(self.series, part) for part in parts if part.where.part not in OF_DATA
        }


def error_breakdown(what: Compared, joint: str) -> ErrorBreakdown:
    """The errors of one motor."""
    return ErrorBreakdown(joint, *what.units[joint], what.of(joint))


def _ways(forwards: np.ndarray, backwards: np.ndarray) -> Sequence[tuple[Direction, np.ndarray]]:
    ways: tuple[tuple[Direction, np.ndarray], ...] = (("forwards", forwards), ("backwards", backwards))
    return [(direction, way) for direction, way in ways if way.any()]
