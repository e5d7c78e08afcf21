"""The observation matrix of every recording, sampled, filtered and decimated (equations 9 and 12)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.effects import EffectInstance, JointSignals
from bench.errors import BenchError
from bench.estimate.standstill import moving_rows
from bench.model.model import IdentificationModel
from bench.model.motion import motion_of
from bench.model.regressor import projected_regressor
from bench.recording import Recording
from bench.signals.decimation import decimate, decimated_indices
from bench.signals.processing import estimate_motion, trim
from bench.signals.settings import FilterSettings


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


def observe(
    model: IdentificationModel,
    recording: Recording,
    settings: FilterSettings,
    effects: Sequence[EffectInstance],
) -> Observation:
    """Filter and differentiate the positions, close the loops, and decimate every column alike.

    Raises BenchError that names the recording and the time of a sample that cannot be used.
    """
    motion = estimate_motion(recording.position, recording.rate, settings)
    time, current = trim(recording.time, settings), trim(recording.current, settings)
    try:
        tree = motion_of(model.geometry, time, motion.position, motion.velocity, motion.acceleration)
    except BenchError as error:
        raise BenchError(f"{recording.name}: {error}") from None
    columns = model.base.columns
    loaded = recording.payload is not None
    if loaded:
        columns = np.concatenate((columns, model.payload_columns))
    rows = projected_regressor(model.geometry, tree, columns)
    nb, ne = len(model.base.columns), sum(len(one.effect.parameters) for one in effects)
    samples, n = current.shape
    stacked = np.concatenate(
        (
            rows[:, :, :nb].reshape(samples, -1),
            (rows[:, :, nb:] @ model.payload).reshape(samples, -1) if loaded else np.empty((samples, 0)),
            _effect_columns(
                model, effects, time, motion.position, motion.velocity, motion.acceleration, current
            ),
            current,
            motion.position,
            motion.velocity,
            motion.acceleration,
        ),
        axis=1,
    )
    kept = decimate(stacked, settings.decimation)
    sizes = np.cumsum([n * nb, 10 * n if loaded else 0, n * ne, n, n, n])
    rigid, payload, effect, current, position, velocity, acceleration = np.split(kept, sizes, axis=1)
    count = len(kept)
    return Observation(
        name=recording.name,
        use=recording.use,
        payload_name=recording.payload,
        time=time[decimated_indices(samples, settings.decimation)],
        current=current,
        rigid=rigid.reshape(count, n, nb),
        payload=payload.reshape(count, n, 10) if loaded else None,
        effects=effect.reshape(count, n, ne),
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        moving=np.ones((count, n), dtype=bool)
        if settings.keep_standstill
        else moving_rows(motion.velocity, recording.rate, settings.decimation),
    )


def _effect_columns(
    model: IdentificationModel,
    effects: Sequence[EffectInstance],
    time: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    current: np.ndarray,
) -> np.ndarray:
    """Columns of all effects, (N, n * ne), motor by motor."""
    actuators = model.geometry.robot.actuators
    names = [actuator.joint for actuator in actuators]
    width = sum(len(one.effect.parameters) for one in effects)
    columns = np.zeros((len(time), len(names), width))
    at = 0
    for instance in effects:
        j = names.index(instance.joint)
        signals = JointSignals(
            time, position[:, j], velocity[:, j], acceleration[:, j], current[:, j], actuators[j].gain
        )
        count = len(instance.effect.parameters)
        columns[:, j, at : at + count] = instance.effect.columns(signals)
        at += count
    return columns.reshape(len(time), -1)
