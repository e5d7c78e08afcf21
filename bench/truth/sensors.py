"""Sensors: from the true motion to the log of the controller."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.scenario.scenario import per_joint
from bench.scenario.tables import Sensors
from bench.truth.streams import stream

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Log:
    """The log of one run, N samples of n joints, and its errors."""

    time: Array
    """(N,) s."""
    position: Array
    """(N, n) rad or m."""
    current: Array
    """(N, n) current reference in the drive's unit."""
    position_noise: Array
    """(n,) standard deviation of the noise, before quantisation."""
    current_noise: Array
    """(n,) standard deviation of the noise, before quantisation."""
    position_error: Array
    """(n,) RMS of logged − true position, quantisation included."""
    current_error: Array
    """(n,) RMS of logged − true current reference, quantisation included."""


def sense(
    sensors: Sensors,
    joints: Sequence[str],
    seed: int,
    name: str,
    time: Array,
    position: Array,
    current: Array,
) -> Log:
    """Log the true time (N,), positions and current references (N, n) of the recording `name`.

    Noise is added first, then values are quantised to whole steps. Every channel has a separate random stream, from
    the seed and the names of recording and channel, so that no recording depends on another.
    """
    position_noise = per_joint(sensors.position_noise, joints)
    current_noise = _current_noise(sensors, joints, current)
    logged_position = _quantised(
        position + position_noise * _normal(seed, name, "position", joints, len(time)),
        _encoder_step(sensors, joints),
    )
    logged_current = _quantised(
        current + current_noise * _normal(seed, name, "current", joints, len(time)),
        per_joint(sensors.current_resolution, joints),
    )
    jitter = sensors.time_jitter * stream(seed, name, "time").standard_normal(len(time))
    return Log(
        time + jitter,
        logged_position,
        logged_current,
        position_noise,
        current_noise,
        _rms(logged_position - position),
        _rms(logged_current - current),
    )


def _current_noise(sensors: Sensors, joints: Sequence[str], current: Array) -> Array:
    """Standard deviation (n,) of the current noise."""
    if sensors.current_noise_ratio:
        return per_joint(sensors.current_noise_ratio, joints) * _rms(current)
    return per_joint(sensors.current_noise, joints)


def _encoder_step(sensors: Sensors, joints: Sequence[str]) -> Array:
    """Size (n,) of an encoder's step, rad or m; 0 means continuous."""
    if sensors.encoder_bits:
        return np.full(len(joints), 2 * np.pi / 2**sensors.encoder_bits)
    return per_joint(sensors.encoder_resolution, joints)


def _normal(seed: int, name: str, kind: str, joints: Sequence[str], count: int) -> Array:
    """Standard normal numbers (count, n), a stream for each joint."""
    return np.column_stack([stream(seed, name, f"{kind}.{joint}").standard_normal(count) for joint in joints])


def _quantised(values: Array, step: Array) -> Array:
    """Values (N, n) rounded to whole steps (n,), where a step is not 0."""
    size = np.where(step > 0, step, 1.0)
    return np.where(step > 0, np.round(values / size) * size, values)


def _rms(values: Array) -> Array:
    return np.sqrt(np.mean(values**2, axis=0))
