"""The observation matrix of every recording, sampled, filtered and decimated (equations 9 and 12)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.basics.errors import BenchError
from bench.identification.filtered import Measured
from bench.identification.standstill import around, interpolated_part, moving_rows
from bench.identification.tolerances import TOLERANCES
from bench.model.model import IdentificationModel
from bench.model.motion import blocks_of
from bench.model.nodes import of_recording
from bench.model.regressor import projected_regressor, redundant_columns
from bench.signals.decimation import Decimation, decimated_indices
from bench.signals.returning import Course


@dataclass(frozen=True)
class Observation:
    """One recording at the fit's rate, M samples of n motors.

    time (M,) s; current (M, n) drive unit; rigid (M, n, nb), payload (M, n, 10) or None, effects (M, n, ne): torque or
    force for each unit of the base parameters, of the payload's standard parameters in the tool frame, and of the
    effects' parameters. redundant (M, n, r): for each unit of the redundant motors' drive gains, whose nominal values
    are nominal (r,). position, velocity, acceleration (M, n) of the active joints. moving (M, n): False where the joint
    is at rest; such rows are neither fitted nor judged. course: the positions; it remembers whether they return.
    """

    name: str
    use: Literal["identify", "validate"]
    payload_name: str | None
    time: np.ndarray
    current: np.ndarray
    rigid: np.ndarray
    payload: np.ndarray | None
    effects: np.ndarray
    redundant: np.ndarray
    nominal: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    moving: np.ndarray
    course: Course


def observe(model: IdentificationModel, measured: Measured) -> Observation:
    """The rigid-body columns of a recording, filtered and decimated like its currents; no effects yet."""
    recording, settings = measured.recording, measured.settings
    columns = model.base.columns
    loaded = recording.payload is not None
    if loaded:
        columns = np.concatenate((columns, model.payload_columns))
    robot = model.geometry.robot
    nb, r = len(columns), len(robot.redundant)
    columns = np.concatenate((columns, redundant_columns(model.geometry)))
    samples, n, p = len(measured.time), measured.current.shape[1], len(columns)
    decimation = Decimation(samples, settings.decimation)
    try:
        for part in blocks_of(samples, TOLERANCES.memory.samples):
            decimation.push(_stacked(model, measured, columns, part))
    except BenchError as error:  # of a long log, whose loops are closed on demand
        raise of_recording(recording.name, error) from None
    kept = decimation.finish()
    sizes = np.cumsum([n * p, n, n, n])
    filtered, current, position, velocity, acceleration = np.split(kept, sizes, axis=1)
    filtered = filtered.reshape(len(kept), n, p)
    load, nb = slice(len(model.base.columns), nb), len(model.base.columns)
    position = np.ascontiguousarray(position)
    return Observation(
        name=recording.name,
        use=recording.use,
        payload_name=recording.payload,
        time=measured.time[decimated_indices(samples, settings.decimation)],
        current=np.ascontiguousarray(current),
        rigid=np.ascontiguousarray(filtered[:, :, :nb]),
        payload=filtered[:, :, load] @ model.payload if loaded and model.payload is not None else None,
        effects=np.zeros((len(kept), n, 0)),
        redundant=filtered[:, :, p - r :].copy(),  # a view, even of no columns, would keep all of `filtered`
        nominal=np.array([actuator.gain for actuator in robot.redundant]),
        position=position,
        velocity=np.ascontiguousarray(velocity),
        acceleration=np.ascontiguousarray(acceleration),
        moving=moving_rows(measured.gaps, samples, settings.decimation),
        course=Course(position),
    )


def _stacked(model: IdentificationModel, measured: Measured, columns: np.ndarray, part: slice) -> np.ndarray:
    """Part of a recording before decimation, interpolated: (K, n p + 4 n), columns and currents, then the motion."""
    length, n = len(measured.time), measured.current.shape[1]
    seen = around(part, measured.gaps, length)
    samples = part if len(seen) == part.stop - part.start else seen
    rows = projected_regressor(model.geometry, measured.tree.at(samples), columns)
    if r := measured.redundant.shape[1]:
        rows[:, :, -r:] *= measured.redundant[samples][:, None, :]
    stacked = np.empty((len(seen), n, len(columns) + 1))
    stacked[:, :, :-1], stacked[:, :, -1] = rows, measured.current[samples]
    stacked = interpolated_part(stacked, seen, part, measured.gaps, length)
    motion = measured.position[part], measured.velocity[part], measured.acceleration[part]
    flat = stacked[:, :, :-1].reshape(len(stacked), -1)
    return np.concatenate((flat, stacked[:, :, -1], *motion), axis=1)


def all_currents(measured: Measured) -> np.ndarray:
    """Every current for every motor's rows, interpolated at that motor's standstill: (M, n, n), drive units."""
    length, n = measured.current.shape
    decimation = Decimation(length, measured.settings.decimation)
    for part in blocks_of(length, TOLERANCES.memory.samples):
        seen = around(part, measured.gaps, length)
        rows = np.repeat(measured.current[seen][:, None, :], n, axis=1)
        decimation.push(interpolated_part(rows, seen, part, measured.gaps, length).reshape(-1, n * n))
    return decimation.finish().reshape(-1, n, n)
