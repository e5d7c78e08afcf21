"""From measured positions to positions, velocities and accelerations for the model, and to the fit's rows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.differentiation import central_difference
from bench.signals.filtering import low_pass
from bench.signals.settings import FilterSettings

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
    - border[1]. logged: velocities that are taken in place of differentiated positions, shape (N, n); NaN for none.
    """
    filtered = low_pass(position, rate, settings.position_cutoff, settings.filter_order)
    velocity = central_difference(filtered, 1 / rate, settings.difference_order)
    if logged is not None:
        taken = ~np.isnan(logged).any(axis=0)
        velocity[:, taken] = low_pass(logged[:, taken], rate, settings.position_cutoff, settings.filter_order)
    acceleration = central_difference(velocity, 1 / rate, settings.difference_order)
    return FilteredMotion(trim(filtered, settings), trim(velocity, settings), trim(acceleration, settings))


def trim(x: FloatArray, settings: FilterSettings) -> FloatArray:
    """Return x, shape (N, ...), without its border samples: what belongs to a `Motion`, such as currents.

    Raises BenchError: nothing remains.
    """
    start, end = settings.border
    if len(x) <= start + end:
        raise BenchError(f"filter settings: border {settings.border} leaves nothing of {len(x)} samples")
    return x[start : len(x) - end]
