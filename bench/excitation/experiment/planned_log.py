"""The rows of a fit to planned motions: filters chosen as for a log, rows at standstill omitted."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.excitation.experiment.nominal import Evidence, Nominal, seen
from bench.identification.filtered import passive_rates
from bench.identification.standstill import moving_rows, standstills
from bench.model.motion import Motion, motion_of
from bench.scenario.trajectory import FourierTrajectory
from bench.signals.decimation import decimated_indices
from bench.signals.settings import FilterSettings, choose_settings

SEED = 20120604  # of the noise of a log used only to choose filters


@dataclass(frozen=True)
class PlannedRows:
    """The rows of a fit to one planned motion: the motion at the M rows of the whole log, and moving (M, n): which
    joints' rows count; those at the log's ends, which the filters need, do not.

    decimation: samples of the log for each row.
    """

    motion: Motion
    moving: np.ndarray
    decimation: int


def planned_rows(
    nominal: Nominal, trajectories: Sequence[FourierTrajectory], loads: Sequence[str | None]
) -> list[PlannedRows]:
    """The rows of a fit to all these motions, each with its payload."""
    logs = [_log(nominal, trajectory, load) for trajectory, load in zip(trajectories, loads, strict=True)]
    positions, currents = [log[1] for log in logs], [log[2] for log in logs]
    settings = choose_settings(positions, currents, nominal.noise.rate)
    return [
        _rows(nominal, motion, trajectory, settings)
        for (motion, _, _), trajectory in zip(logs, trajectories, strict=True)
    ]


def row_evidence(nominal: Nominal, rows: PlannedRows, load: str | None) -> Evidence:
    """Evidence of rows on all unknowns of a machine with this payload."""
    what = seen(nominal, rows.motion, load)
    by_motor = (what.jacobian * rows.moving[:, :, None]).transpose(1, 0, 2)
    grams = by_motor.transpose(0, 2, 1) @ by_motor * rows.decimation
    variance = nominal.noise.deviation(what.current) ** 2
    return Evidence(grams, variance, float(len(rows.moving) * rows.decimation))


def _log(
    nominal: Nominal, trajectory: FourierTrajectory, load: str | None
) -> tuple[Motion, np.ndarray, np.ndarray]:
    """Motion, positions and currents as a controller will log them, noise and steps of encoders included."""
    rate = nominal.noise.rate
    time = np.arange(int(trajectory.duration * rate) + 1) / rate
    position, velocity, acceleration = trajectory.evaluate(time)
    motion = motion_of(nominal.model.geometry, time, position, velocity, acceleration)
    current = seen(nominal, motion, load).current
    noise = np.random.default_rng(SEED).normal(size=current.shape) * nominal.noise.deviation(current)
    step = nominal.noise.encoder
    size = np.where(step > 0.0, step, 1.0)
    position = np.where(step > 0.0, np.round(position / size) * size, position)
    return motion, position, current + noise


def _rows(
    nominal: Nominal, motion: Motion, trajectory: FourierTrajectory, settings: FilterSettings
) -> PlannedRows:
    start, end = settings.border
    count, length = len(motion.time) - start - end, len(motion.time)
    inner = motion.at(slice(start, length - end))
    position, velocity, _ = trajectory.evaluate(inner.time)
    passive = passive_rates(nominal.model.geometry, inner)
    gaps = standstills(position, velocity, passive, nominal.noise.rate, settings.position_cutoff)
    fitted = start + decimated_indices(count, settings.decimation)
    rows = np.arange(fitted[0] % settings.decimation, length, settings.decimation)
    moving = np.zeros((len(rows), position.shape[1]), dtype=bool)
    moving[np.isin(rows, fitted)] = moving_rows(gaps, count, settings.decimation)
    return PlannedRows(motion.at(rows), moving, settings.decimation)
