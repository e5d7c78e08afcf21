"""Errors of the observation matrix's columns: noise propagated through the model."""

from dataclasses import replace

import numpy as np

from bench.dataset.recording import Recording
from bench.identification.closed_loop import columns_at
from bench.identification.filtered import measure
from bench.identification.prepare import Prepared
from bench.signals.decimation import noise_bandwidth
from bench.signals.settings import signal_bands

SEED = 20120603


def column_errors(prepared: Prepared) -> np.ndarray:
    """Expected inner products (n, p + 2, p + 2) of the errors of [phi, kappa, current], motor by motor.

    The noise of positions and currents is read off the spectra above the band of the motion, taken as white. The same
    amount of noise is added to the positions, with a fixed seed; the change of the columns is an estimate of their
    error.
    """
    settings = prepared.settings

    def columns(recording: Recording) -> np.ndarray:
        return columns_at(prepared, measure(prepared.model, recording, settings))

    random = np.random.default_rng(SEED)
    parts = []
    for recording in [entry.recording for entry in prepared.measured if entry.recording.use == "identify"]:
        rate = recording.rate
        bands = signal_bands([recording.position], [recording.current], rate)
        change = columns(perturbed(recording, bands.position_noise, random)) - columns(recording)
        samples, n, size = change.shape
        errors = np.zeros((n, size + 1, size + 1))
        errors[:, :size, :size] = np.einsum("kjp,kjq->jpq", change, change)
        variance = bands.current_noise * rate / 2 * noise_bandwidth(settings.decimation)
        errors[:, size, size] = samples * variance
        parts.append(errors)
    return np.asarray(np.sum(parts, axis=0))


def perturbed(recording: Recording, density: np.ndarray, random: np.random.Generator) -> Recording:
    """The recording with white noise of this density (n,), rad2/Hz or m2/Hz, added to its positions."""
    noise = np.sqrt(density * recording.rate / 2) * random.normal(size=recording.position.shape)
    return replace(recording, position=recording.position + noise)
