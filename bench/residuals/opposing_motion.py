"""Error that opposes the motion as friction does: at the start and the end, with and without payload."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.residuals.autocorrelation import correlations, integrated_autocorrelation_time
from bench.residuals.bounds import ERROR_GRID, NAMING
from bench.residuals.motor import MotorSeries


@dataclass(frozen=True)
class Opposing:
    """Mean of error times sign of velocity with its deviation, drive unit, and the relative error, of one motor.

    Positive: the motor needs more current than the model in both directions.
    """

    joint: str
    part: str
    mean: float
    std: float
    error: float | None


@dataclass(frozen=True)
class Change:
    """Two parts whose opposing errors differ far beyond chance. between: start and end, or two loads."""

    between: Literal["warm-up", "load"]
    first: Opposing
    second: Opposing


def over_warm_up(series: Sequence[MotorSeries]) -> tuple[Opposing, Opposing]:
    """The first and the last third of all recordings of one motor."""
    first = [np.flatnonzero(trace.time <= ERROR_GRID.third * trace.time[-1]) for trace in series]
    last = [np.flatnonzero(trace.time >= (1.0 - ERROR_GRID.third) * trace.time[-1]) for trace in series]
    return (
        _opposing(series, first, "in the first third of the recordings"),
        _opposing(series, last, "in the last third"),
    )


def by_load(series: Sequence[MotorSeries]) -> list[Opposing]:
    """Each payload of one motor, and none."""
    loads = list(dict.fromkeys(trace.payload for trace in series))
    comparisons = []
    for load in loads:
        rows = [np.arange(len(trace.time) if trace.payload == load else 0) for trace in series]
        comparisons.append(_opposing(series, rows, f"with payload {load}" if load else "without payload"))
    return comparisons


def changes(series: Sequence[MotorSeries]) -> list[Change]:
    """Pairs of parts that differ: friction that changes over the recordings, or with the load."""
    loads = by_load(series)
    pairs: list[Change] = [Change("warm-up", *over_warm_up(series))]
    pairs += [Change("load", loads[0], opposing) for opposing in loads[1:]]
    rms = float(np.sqrt(np.mean(np.concatenate([trace.error for trace in series]) ** 2)))
    return [
        change
        for change in pairs
        if (by := abs(change.first.mean - change.second.mean)) > NAMING.drift * rms
        and by > NAMING.drift_deviations * float(np.hypot(change.first.std, change.second.std))
    ]


def _opposing(series: Sequence[MotorSeries], rows: Sequence[np.ndarray], part: str) -> Opposing:
    used = [(trace, chosen) for trace, chosen in zip(series, rows, strict=True) if len(chosen) > 1]
    if not used:
        return Opposing(series[0].joint, part, 0.0, float("inf"), None)
    values = [(trace.error * np.sign(trace.velocity))[chosen] for trace, chosen in used]
    whole = np.concatenate(values)
    mean = float(whole.mean())
    scatter = [_without_trend(v) for v in values]
    alike = integrated_autocorrelation_time(
        correlations([trace.row[chosen] for trace, chosen in used], scatter)
    )
    std = float(np.concatenate(scatter).std() * np.sqrt(alike / len(whole)))
    error = sum(float((trace.error[chosen] ** 2).sum()) for trace, chosen in used)
    measured = sum(float((trace.measured[chosen] ** 2).sum()) for trace, chosen in used)
    return Opposing(series[0].joint, part, mean, std, float(np.sqrt(error / measured)) if measured else None)


def _without_trend(values: np.ndarray) -> np.ndarray:
    """Values (N,) less a fitted line: a steady change is not scatter of the mean."""
    at = np.linspace(-1.0, 1.0, len(values))
    return np.asarray(values - values.mean() - at * (at @ values) / (at @ at))
