"""How large the errors of the observation matrix's columns are: noise carried through the model."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from bench.estimate.observation import Observation
from bench.recording import Recording
from bench.signals.decimation import noise_bandwidth
from bench.signals.settings import FilterSettings, signal_bands

SEED = 20120603

Columns = Callable[[Observation], tuple[np.ndarray, np.ndarray]]


def column_errors(
    recordings: Sequence[Recording],
    observations: Sequence[Observation],
    settings: FilterSettings,
    observe: Callable[[Recording], Observation],
    columns: Columns,
) -> np.ndarray:
    """Expected inner products (n, p + 2, p + 2) of the errors of [phi, kappa, current], motor by motor.

    The noise of positions and currents is read off the spectra above the band of the motion, taken as white.
    As much noise once more is added to the positions, with a fixed seed; what it changes in the columns
    stands for what the measured noise did. `columns` gives phi (M, n, p) and kappa (M, n) of an observation.
    """
    random = np.random.default_rng(SEED)
    total: np.ndarray | None = None
    for recording, observation in zip(recordings, observations, strict=True):
        rate = recording.rate
        bands = signal_bands([recording.position], [recording.current], rate)
        deviation = np.sqrt(bands.position_noise * rate / 2)
        shaken = replace(
            recording, position=recording.position + deviation * random.normal(size=recording.position.shape)
        )
        (phi, kappa), (phi_shaken, kappa_shaken) = columns(observation), columns(observe(shaken))
        change = np.concatenate((phi_shaken - phi, (kappa_shaken - kappa)[:, :, None]), axis=2)
        samples, n, size = change.shape
        errors = np.zeros((n, size + 1, size + 1))
        errors[:, :size, :size] = np.einsum("kjp,kjq->jpq", change, change)
        variance = bands.current_noise * rate / 2 * noise_bandwidth(settings.decimation)
        errors[:, size, size] = samples * variance
        total = errors if total is None else total + errors
    assert total is not None
    return total
