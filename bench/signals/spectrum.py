"""Power spectra of measured signals: the end of the signal, and the noise.

Source of the averaged periodogram: P. D. Welch, "The use of fast Fourier transform for the estimation of
power spectra", IEEE Trans. Audio Electroacoustics 15, 1967.
"""

from functools import lru_cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.bounds import SPECTRA

FloatArray = NDArray[np.float64]


def _high_pass() -> FloatArray:
    """118 dB down below 0.26 of half the rate, with a second difference against large slow motions."""
    place = np.arange(SPECTRA.taps) - SPECTRA.taps // 2
    ideal = np.sinc(place) - 0.5 * np.sinc(0.5 * place)
    taps = ideal * np.kaiser(SPECTRA.taps, SPECTRA.taper)
    return np.convolve(taps / (taps @ np.cos(np.pi * place)), [-1.0, 2.0, -1.0])


HIGH_PASS = _high_pass()


def power_spectrum(x: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Return frequencies [Hz], shape (F,), and one-sided power densities [unit^2/Hz], shape (F, n).

    x: samples at a uniform rate, shape (N, n). rate: sampling rate [Hz]. Raises BenchError: fewer than 100 samples.
    """
    x = np.asarray(x, dtype=float)
    if len(x) < SPECTRA.shortest:
        raise BenchError(f"spectrum: {len(x)} samples are too few, it needs at least {SPECTRA.shortest}")
    length = min(len(x), max(SPECTRA.shortest, len(x) // SPECTRA.segments, int(SPECTRA.segment * rate)))
    return _averaged(x, rate, _window(length), length - length * 4 // 5, centred=True)


def hann_spectrum(x: FloatArray, rate: float, length: int, *, centred: bool) -> tuple[FloatArray, FloatArray]:
    """The same of one signal x (N,), from Hann windows of `length` samples that overlap by half: (F,) both.

    centred: whether each segment's mean is subtracted first.
    """
    window = np.hanning(length + 1)[:-1]
    frequency, density = _averaged(x[:, None], rate, window, length - length // 2, centred=centred)
    return frequency, density[:, 0]


def _averaged(
    x: FloatArray, rate: float, window: FloatArray, step: int, *, centred: bool
) -> tuple[FloatArray, FloatArray]:
    """Averaged periodogram of the columns of x (N, n), in windows that begin every `step` samples."""
    length = len(window)
    starts = range(0, len(x) - length + 1, step)
    channels = np.ascontiguousarray(x.T)
    power = np.zeros((len(channels), length // 2 + 1))
    for start in starts:
        segment = channels[:, start : start + length]
        level = segment.mean(axis=1, keepdims=True) if centred else 0.0
        lines = np.fft.rfft((segment - level) * window, axis=1)
        power += lines.real**2 + lines.imag**2
    density = (power / len(starts)).T * (2.0 / (rate * (window @ window)))
    density[0] /= 2.0
    if length % 2 == 0:
        density[-1] /= 2.0
    frequency = np.arange(len(density), dtype=float) * (rate / length)
    return frequency, np.asarray(density, dtype=float)


@lru_cache(maxsize=16)
def _window(length: int) -> FloatArray:
    return np.kaiser(length + 1, SPECTRA.kaiser)[:-1]


def noise_density(x: FloatArray, rate: float) -> FloatArray:
    """Return the density [unit^2/Hz] of the white noise on each channel, shape (n,).

    A short high-pass keeps the upper half of the spectrum, which is only noise except for sudden steps, such as Coulomb
    friction at a reversal. Those are prominent in time, so samples beyond four standard deviations are omitted with
    their neighbours, until none remains. A spectrum could not distinguish their tail from noise.

    x: samples at a uniform rate, shape (N, n). rate: sampling rate [Hz].
    """
    x = np.asarray(x, dtype=float)
    if len(x) < SPECTRA.shortest:
        raise BenchError(f"noise: {len(x)} samples are too few, it needs at least {SPECTRA.shortest}")
    centred = np.array(x.T, order="C")
    centred -= centred.mean(axis=1, keepdims=True)
    variance = [_clipped_power(np.convolve(channel, HIGH_PASS, mode="valid")) for channel in centred]
    return np.asarray(np.array(variance) / (HIGH_PASS @ HIGH_PASS) / (rate / 2), dtype=float)


def _clipped_power(x: FloatArray) -> float:
    power = x * x
    kept = np.ones(len(x))
    count, level = len(x), float(power.mean())
    while True:
        loud = np.flatnonzero(power > SPECTRA.clip * SPECTRA.clip * level)
        quiet = np.ones(len(x))
        for start in np.maximum(loud - SPECTRA.neighbours, 0).tolist():
            quiet[start : start + 2 * SPECTRA.neighbours + 1] = 0.0
        kept *= quiet
        kept_count = int(kept.sum())
        if kept_count == count or quiet.sum() < len(x) / 10:
            return level
        count, level = kept_count, float(power @ kept) / kept_count


def noise_floor(x: FloatArray, rate: float, band: float) -> FloatArray:
    """Return the RMS of the measurement noise below a frequency, for each channel, shape (n,).

    The noise is taken as white: its density in the upper half of the spectrum is extended downwards. Coloured noise (a
    controller that amplifies encoder noise into the current, drift) is not detected. After decimation by a factor, band
    is noise_bandwidth(factor) * rate / 2.

    x: samples, shape (N, n), any unit. rate: sampling rate [Hz]. band: upper end of the band [Hz], at most rate / 2.
    """
    if not 0 < band <= rate / 2:
        raise BenchError(f"noise floor: band {band:g} Hz must lie between 0 and {rate / 2:g} Hz")
    return np.asarray(np.sqrt(noise_density(x, rate) * band), dtype=float)


def quantisation_density(x: FloatArray, rate: float) -> FloatArray:
    """Return the density [unit^2/Hz] of the rounding error of each channel, shape (n,).

    The step q is the smallest distance of two values. The error has the variance q^2 / 12, white up to half
    the rate while the signal crosses steps faster than it is sampled, and up to about speed / q when it is
    slower (W. R. Bennett, "Spectra of quantized signals", Bell System Technical Journal 27, 1948).
    Signals that are not rounded have a tiny q and so no such noise.
    """
    x = np.asarray(x, dtype=float)
    density = np.zeros(x.shape[1])
    for j, channel in enumerate(x.T):
        values = np.unique(channel)
        steps = np.diff(values)
        steps = steps[steps > 1e-12 * np.abs(values).max()]
        if len(steps):
            q = steps.min()
            crossings = np.sqrt(np.mean(np.diff(channel) ** 2)) * rate / q
            density[j] = q * q / 12 / min(rate / 2, crossings)
    return density


def signal_density(density: FloatArray, floor: FloatArray) -> FloatArray:
    """Return the density without the noise, shape (F, n): zero where it is below three times the floor."""
    return np.where(density > SPECTRA.outlier * floor, density - floor, 0.0)


def leading_signal_density(density: FloatArray, floor: FloatArray) -> FloatArray:
    """Return `signal_density` up to where the signal first falls into the noise, and zero above.

    That is where the width of a window's main lobe has nothing above three times the floor. For accelerations from
    positions: the fourth power of frequency would amplify a chance peak.
    """
    loud = density > SPECTRA.outlier * floor
    ahead = sliding_window_view(np.pad(loud, ((0, SPECTRA.lobe - 1), (0, 0))), SPECTRA.lobe, axis=0).any(
        axis=-1
    )
    ended = np.maximum.accumulate(~ahead, axis=0)
    return np.where(ended, 0.0, signal_density(density, floor))


def band_edge(frequency: FloatArray, density: FloatArray, loss: float) -> float:
    """Return the lowest frequency [Hz] above which no channel has more than a share `loss` of its power.

    frequency: uniform from 0, shape (F,) [Hz]. density: power densities of the signal alone, shape (F, n); channels
    without power are skipped. loss: between 0 and 1.
    """
    below = np.cumsum(density, axis=0)
    total = below[-1]
    live = total > 0
    if not live.any():
        return 0.0
    reached = below[:, live] >= (1 - loss) * total[live]
    return float(frequency[np.argmax(reached, axis=0)].max())


def noise_from(frequency: FloatArray, position: FloatArray) -> FloatArray:
    """Return the frequency [Hz] from which on a position's spectrum is noise that is not white, shape (n,).

    A motion's acceleration fades with the frequency; that of noise rises, since it is differentiated twice. So noise
    begins at the least acceleration, if this has faded to a hundredth and rises again. Or a controller's jitter keeps
    it level up to the end of the spectrum, over at least two octaves: then noise begins there, if it has faded to a
    thirtieth. Else infinite. Friction and cogging torques give level spectra only for a while. The largest density
    within an octave counts, as a repeated motion has separate lines.

    frequency: uniform from 0, shape (F,) [Hz]. position: power densities without white noise, shape (F, n) [unit^2/Hz].
    """
    omega = 2 * np.pi * frequency
    limits = np.full(position.shape[1], np.inf)
    for j, density in enumerate(position.T):
        shown = np.flatnonzero(density)
        if not len(shown):
            continue
        first, last = int(np.argmax(omega**2 * density)), int(shown[-1]) // 2
        if last <= first:
            continue
        octaves = largest_within_octaves(omega**4 * density, max(first, 1), last)
        least = int(np.argmin(octaves))
        if (
            SPECTRA.faded * octaves[least] < octaves[0]
            and octaves[least:].max() > SPECTRA.risen * octaves[least]
        ):
            limits[j] = frequency[max(first, 1) + least]
        else:
            level = _level_from(octaves, max(first, 1))
            limits[j] = np.inf if level is None else frequency[level]
    return limits


def largest_within_octaves(values: FloatArray, first: int, last: int) -> FloatArray:
    """max(values[i : 2 * i + 1]) for i from first to last; 2 * last must be an index. From two overlapping windows,
    each of a power of two of values.
    """
    starts = np.arange(first, last + 1)
    sizes = np.frexp(starts + 1)[1] - 1
    largest = np.empty(len(starts))
    windows, size = values, 0
    for power in range(int(sizes[0]), int(sizes[-1]) + 1):
        while size < power:
            windows = np.maximum(windows[: -(1 << size)], windows[1 << size :])
            size += 1
        of_size = sizes == power
        largest[of_size] = np.maximum(
            windows[starts[of_size]], windows[2 * starts[of_size] + 1 - (1 << power)]
        )
    return largest


def _level_from(octaves: FloatArray, first: int) -> int | None:
    """The frequency (index) from which a faded acceleration stays level up to the end; octaves (K,): its largest value
    within an octave from each frequency, the lowest at `first`.
    """
    index = first + np.arange(len(octaves))
    least = np.minimum.accumulate(octaves[::-1])[::-1]
    level = (
        (least * SPECTRA.falls > octaves)
        & (octaves * SPECTRA.level < octaves[0])
        & (index * SPECTRA.level_ratio <= index[-1])
    )
    places = np.flatnonzero(level)
    return int(index[places[0]]) if len(places) else None
