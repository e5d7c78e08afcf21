"""Limits of a new motion: the robot's joint ranges, and the rates that recordings have shown to be safe."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.rival_models import Rival
from bench.excitation.limits import Limits, limits_of
from bench.signals.settings import signal_bands


@dataclass(frozen=True)
class Envelope:
    """All limits of a new motion. joint: ranges and distance from singular poses; velocity, acceleration,
    current (n,): largest sizes; stroke (n,): smallest travel of a joint that moves; frequency Hz: of the fastest
    harmonic; band Hz: of a fit to the given data.
    """

    joint: Limits
    velocity: np.ndarray
    acceleration: np.ndarray
    current: np.ndarray
    stroke: np.ndarray
    frequency: float
    band: float


def envelope(rival: Rival, widen: float) -> Envelope:
    """The limits, those of the recordings times `widen`."""
    prepared = rival.prepared
    measured, recordings = prepared.measured, [measurement.recording for measurement in prepared.measured]
    rate = recordings[0].rate
    bands = signal_bands(
        [recording.position for recording in recordings],
        [recording.current for recording in recordings],
        rate,
    )
    slowest = 1.0 / max(float(np.ptp(recording.time)) for recording in recordings)
    return Envelope(
        joint=limits_of(prepared.model.geometry),
        velocity=widen * _largest([measurement.velocity for measurement in measured]),
        acceleration=widen * _largest([measurement.acceleration for measurement in measured]),
        current=widen * DISCRIMINATION.current * _largest([recording.current for recording in recordings]),
        stroke=DISCRIMINATION.stroke
        * np.ptp(np.concatenate([recording.position for recording in recordings]), axis=0),
        frequency=DISCRIMINATION.faster * max(bands.motion, slowest),
        band=prepared.settings.band(rate),
    )


def _largest(series: Sequence[np.ndarray]) -> np.ndarray:
    """Largest size of every column (n,) over all series (N, n)."""
    return np.max([np.abs(values).max(axis=0) for values in series], axis=0)
