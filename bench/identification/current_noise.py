"""How noisy the measured currents are, read off their spectra."""

import numpy as np

from bench.dataset.recording import Recording
from bench.signals.decimation import noise_bandwidth
from bench.signals.settings import FilterSettings
from bench.signals.spectrum import noise_floor


def current_noise(
    recording: Recording, settings: FilterSettings, sharing: np.ndarray | None = None
) -> np.ndarray:
    """RMS of the noise of the currents after the fit's filters (n,), drive unit; sharing: see `CurrentSeries`.

    It is read off the spectra above the band of the motion and taken as white.
    """
    band = noise_bandwidth(settings.decimation) * recording.rate / 2
    noise = noise_floor(recording.current, recording.rate, band)
    if sharing is None:
        return noise
    return np.sqrt(
        noise**2 + sharing**2 @ noise_floor(recording.redundant_current, recording.rate, band) ** 2
    )
