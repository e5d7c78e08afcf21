"""The observation matrix of every recording, sampled, filtered and decimated (equations 9 and 12)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.effects import ActuatorEffect, EffectInstance, RobotSignals, effect_columns
from bench.estimate.measured import Measured
from bench.estimate.standstill import bridged, moving_rows
from bench.model.model import IdentificationModel
from bench.model.regressor import projected_regressor
from bench.signals.decimation import decimate, decimated_indices


@dataclass(frozen=True)
class Observation:
    """One recording at the fit's rate, M samples of n motors.

    time (M,) s; current (M, n) drive unit; rigid (M, n, nb), payload (M, n, 10) or None, effects (M, n, ne):
    torque or force for each unit of the base parameters, of the payload's standard parameters in the tool
    frame, and of the effects' parameters. position, velocity, acceleration (M, n) of the active joints.
    moving (M, n): False where the joint stands still; such rows are neither fitted nor judged.
    """

    name: str
    use: Literal["identify", "validate"]
    payload_name: str | None
    time: np.ndarray
    current: np.ndarray
    rigid: np.ndarray
    payload: np.ndarray | None
    effects: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    moving: np.ndarray


def observe(model: IdentificationModel, measured: Measured) -> Observation:
    """The rigid-body columns of a recording, filtered and decimated like its currents; no effects yet."""
    recording, settings = measured.recording, measured.settings
    columns = model.base.columns
    loaded = recording.payload is not None
    if loaded:
        columns = np.concatenate((columns, model.payload_columns))
    rows = projected_regressor(model.geometry, measured.tree, columns)
    samples, n, p = rows.shape
    stacked = np.concatenate(
        (
            bridged(rows, measured.gaps).reshape(samples, -1),
            bridged(measured.current, measured.gaps),
            measured.position,
            measured.velocity,
            measured.acceleration,
        ),
        axis=1,
    )
    kept = decimate(stacked, settings.decimation)
    sizes = np.cumsum([n * p, n, n, n])
    filtered, current, position, velocity, acceleration = np.split(kept, sizes, axis=1)
    filtered = filtered.reshape(len(kept), n, p)
    nb = len(model.base.columns)
    return Observation(
        name=recording.name,
        use=recording.use,
        payload_name=recording.payload,
        time=measured.time[decimated_indices(samples, settings.decimation)],
        current=current,
        rigid=np.ascontiguousarray(filtered[:, :, :nb]),
        payload=filtered[:, :, nb:] @ model.payload if loaded and model.payload is not None else None,
        effects=np.zeros((len(kept), n, 0)),
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        moving=moving_rows(measured.gaps, samples, settings.decimation),
    )


def effect_rows(signals: RobotSignals, decimation: int, effects: Sequence[EffectInstance]) -> np.ndarray:
    """The columns of effects in one recording, filtered and decimated like the currents, (M, n, ne)."""
    samples, n = len(signals.time), len(signals.joints)
    nothing = np.zeros((len(decimated_indices(samples, decimation)), n, 0))
    return np.concatenate([nothing, *(_rows_of(signals, decimation, one) for one in effects)], axis=2)


def _rows_of(signals: RobotSignals, decimation: int, instance: EffectInstance) -> np.ndarray:
    """The rows (M, n, k) of one effect, computed only where they are not known yet."""
    alone = isinstance(instance.effect, ActuatorEffect)  # which sees its own motor, and no other joint move
    passing = instance.effect.depends_on_model or not (alone or signals.as_measured)
    kept = signals.passing if passing else signals.lasting
    key = instance.effect, instance.joint, decimation
    try:
        rows = kept.get(key)
    except TypeError:  # a user's class need not be hashable
        return _computed(signals, decimation, instance)
    if rows is None:
        rows = _computed(signals, decimation, instance)
        kept.keep(key, rows)
    return rows


def _computed(signals: RobotSignals, decimation: int, instance: EffectInstance) -> np.ndarray:
    columns = effect_columns(instance, signals)
    flat = bridged(columns, signals.gaps).reshape(len(columns), -1)
    filled = np.flatnonzero(flat.any(axis=0))
    rows = np.zeros((len(decimated_indices(len(columns), decimation)), flat.shape[1]))
    rows[:, filled] = decimate(flat[:, filled], decimation)
    return rows.reshape(len(rows), *columns.shape[1:])
