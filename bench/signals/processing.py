"""Measured positions to positions, velocities and accelerations for the model, and to rows of the fit.

Noise of density s on a velocity, differentiated once, has the power (2 pi)^2 s f^3 / 3 in the acceleration up to f; on
a position, differentiated twice, (2 pi)^4 s f^5 / 5.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.bounds import LOGGED
from bench.signals.differentiation import central_difference
from bench.signals.filtering import low_pass
from bench.signals.settings import FilterSettings
from bench.signals.spectrum import noise_density, quantisation_density

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class FilteredMotion:
    """Filtered motion of the measured joints, border samples dropped; each array has shape (M, n).

    position: [rad or m]. velocity: [1/s]. acceleration: [1/s^2].
    """

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


def estimate_motion(
    position: FloatArray, rate: float, settings: FilterSettings, logged: FloatArray | None = None
) -> FilteredMotion:
    """Low-pass the positions, differentiate them twice, and drop the border samples.

    The acceleration is the central difference of the velocity. Source: M. Gautier, ICRA 1997, where this is
    called band-pass differentiation.

    position: measured, shape (N, n). rate: sampling rate [Hz]. settings: their border is dropped, so M = N - border[0]
    - border[1]. logged: velocities used in place of differentiated positions, shape (N, n); NaN for none.
    """
    filtered = low_pass(position, rate, settings.position_cutoff, settings.filter_order)
    velocity = central_difference(filtered, 1 / rate, settings.difference_order)
    if logged is not None:
        taken = ~np.isnan(logged).any(axis=0)
        velocity[:, taken] = low_pass(logged[:, taken], rate, settings.position_cutoff, settings.filter_order)
    acceleration = central_difference(velocity, 1 / rate, settings.difference_order)
    return FilteredMotion(trim(filtered, settings), trim(velocity, settings), trim(acceleration, settings))


def trim(x: FloatArray, settings: FilterSettings) -> FloatArray:
    """Return x, shape (N, ...), such as currents, without border samples, as a `FilteredMotion`.

    Raises BenchError: nothing remains.
    """
    start, end = settings.border
    if len(x) <= start + end:
        raise BenchError(f"filter settings: border {settings.border} leaves nothing of {len(x)} samples")
    return x[start : len(x) - end]


@dataclass(frozen=True)
class LoggedVelocity:
    """Comparison of one joint's logged velocity with its differentiated position, up to the position cut-off.

    scale: factor by which it is larger; delay, s; off: RMS difference over the RMS velocity, noise aside; other: RMS
    not explained by scale and delay, over the RMS of the logged velocity, noise aside; density: of its noise
    [unit^2/Hz]; louder: power of this noise in the acceleration over that of the position's.
    """

    scale: float
    delay: float
    off: float
    other: float
    density: float
    louder: float

    @property
    def agrees(self) -> bool:
        """Whether it is the rate of the position, up to noise."""
        return self.off <= LOGGED.agrees

    @property
    def taken(self) -> bool:
        """Whether it replaces the differentiated position: it agrees, and has clearly less noise."""
        return self.agrees and self.louder < LOGGED.quieter


def compared_velocity(
    position: FloatArray, velocity: FloatArray, rate: float, settings: FilterSettings
) -> LoggedVelocity:
    """A logged velocity (N,) compared with the position (N,) at a rate [Hz]."""
    motion = estimate_motion(position[:, None], rate, settings)
    derived, acceleration = motion.velocity[:, 0], motion.acceleration[:, 0]
    cutoff, order = settings.position_cutoff, settings.filter_order
    logged = trim(low_pass(velocity, rate, cutoff, order), settings)
    columns = np.column_stack((derived, acceleration))
    lengths = np.linalg.norm(columns, axis=0)
    lengths[lengths == 0.0] = 1.0
    scale, late = np.linalg.lstsq(columns / lengths, logged)[0] / lengths
    turned = 2.0 * np.pi * cutoff
    of_position = _density(position, rate) * turned**2 * cutoff / 3.0
    remaining = float(np.mean((logged - columns @ np.array([scale, late])) ** 2))
    density = max(_density(velocity, rate), (remaining - of_position) / cutoff)
    chance = LOGGED.noise * (of_position + density * cutoff)
    off = max(float(np.mean((logged - derived) ** 2)) - chance, 0.0)
    other = max(remaining - chance, 0.0)
    moved = float(np.mean(derived**2))
    once, twice = density * turned**2 * cutoff / 3.0, of_position * turned**2 * 3.0 / 5.0
    tiny = float(np.finfo(float).tiny)
    return LoggedVelocity(
        scale=float(scale),
        delay=-float(late) / (float(scale) or 1.0),
        off=float(np.sqrt(off / max(moved, tiny))),
        other=float(np.sqrt(other / max(float(np.mean(logged**2)), tiny))),
        density=float(density),
        louder=float(once / max(twice, tiny)),
    )


def _density(signal: FloatArray, rate: float) -> float:
    """White noise density of signal (N,) [unit^2/Hz]."""
    channel = signal[:, None]
    return float(max(noise_density(channel, rate)[0], quantisation_density(channel, rate)[0]))
