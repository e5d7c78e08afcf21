"""Noise of the measured currents, from their spectra."""

from collections.abc import Sequence

import numpy as np

from bench.basics.chi_squared import exceeded_with
from bench.dataset.recording import Recording
from bench.identification.decision import RULE
from bench.identification.result import CurrentSeries
from bench.identification.tolerances import TOLERANCES
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


def noise_of_series(recording: Recording, settings: FilterSettings, series: CurrentSeries) -> np.ndarray:
    """As `current_noise` (n,), but if a motor's errors in the upper half of the fit's band are smaller than this noise,
    their density is taken for the whole band: the currents are noisier above the band, as by a controller's hold.
    """
    above = current_noise(recording, settings, series.sharing)
    squares, bins = squares_of_noise(series, settings)
    within = np.sqrt(squares / np.maximum(series.moving.sum(axis=0), 1))
    least = exceeded_with(1.0 - RULE.surprising, 2.0 * bins) / (2.0 * bins)
    return np.where(within**2 < least * above**2, within, above)


def squares_of_noise(series: CurrentSeries, settings: FilterSettings) -> tuple[np.ndarray, int]:
    """Sums of squares (n,) of noise with the density of the errors in the upper half of the fit's band, and the number
    of frequencies of the spectrum there.
    """
    factor = settings.decimation
    band = noise_bandwidth(factor) * factor
    power = np.abs(np.fft.rfft(series.error * series.moving, axis=0)) ** 2
    low, high = (int(band * share * len(power)) for share in TOLERANCES.statistics.noise_alone)
    top = power[low : max(high, low + 1)]
    return np.asarray(band * top.mean(axis=0)), len(top)


def relative_noise_in_band(series: Sequence[CurrentSeries], settings: FilterSettings) -> float:
    """Noise of this density, RMS(noise) / RMS(measured) over recordings; 0 without currents."""
    noise = sum(float(squares_of_noise(trace, settings)[0].sum()) for trace in series)
    measured = sum(float(((trace.measured * trace.moving) ** 2).sum()) for trace in series)
    return float(np.sqrt(noise / measured)) if measured else 0.0
