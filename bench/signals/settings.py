"""How measured signals are filtered before the fit, given or chosen from their spectra."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.bounds import BANDS
from bench.signals.decimation import fit_band
from bench.signals.spectrum import (
    band_edge,
    leading_signal_density,
    noise_density,
    noise_from,
    power_spectrum,
    quantisation_density,
    signal_density,
)

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class FilterSettings:
    """Settings of the filters from measured positions and currents to the rows of the fit.

    position_cutoff: cut-off of the low-pass on positions [Hz]. decimation: one sample in this many is kept, after a
    low-pass. filter_order: order of one pass of the position filter. difference_order: order of the central
    differences: 2, 4, 6 or 8. border: samples dropped at the start and at the end after differentiation, before
    decimation. keep_standstill: whether rows of a joint at rest are fitted and judged; friction takes any value up to
    its limit there.
    """

    position_cutoff: float
    decimation: int
    filter_order: int = 4
    difference_order: int = 8
    border: tuple[int, int] = (0, 0)
    keep_standstill: bool = False

    def __post_init__(self) -> None:
        if not self.position_cutoff > 0:
            raise BenchError(f"filter settings: position_cutoff {self.position_cutoff:g} Hz must be positive")
        if self.decimation < 1:
            raise BenchError(f"filter settings: decimation {self.decimation} must be at least 1")
        if self.filter_order < 1:
            raise BenchError(f"filter settings: filter_order {self.filter_order} must be at least 1")
        if self.difference_order not in (2, 4, 6, 8):
            raise BenchError(
                f"filter settings: difference_order {self.difference_order} is not one of 2, 4, 6, 8"
            )
        if min(self.border) < 0:
            raise BenchError(f"filter settings: border {self.border} must be two numbers, 0 or more")

    def band(self, rate: float) -> float:
        """Return the highest frequency [Hz] in the fit, at a sampling rate [Hz]."""
        return fit_band(rate, self.decimation)


@dataclass(frozen=True)
class Bands:
    """Bands from the spectra of all recordings, frequencies in Hz.

    current: less than a thousandth of the power of every current is above it, noise aside. motion: less than a
    hundredth of the power of every acceleration is above it. fit_limit: below it, noise is at most 1e-5 of the power of
    every acceleration. filter_limit: the same for 1e-3. position_noise: density of the white noise of each position,
    shape (n,) [unit^2/Hz]. current_noise: density of the white noise of each current, shape (n,) [unit^2/Hz].
    """

    current: float
    motion: float
    fit_limit: float
    filter_limit: float
    position_noise: FloatArray
    current_noise: FloatArray


def signal_bands(
    positions: Sequence[FloatArray],
    currents: Sequence[FloatArray],
    rate: float,
    velocity_noise: Sequence[FloatArray] | None = None,
) -> Bands:
    """Read the bands of signals and noise off the spectra of all recordings.

    positions: one array of shape (N, n) for each recording [rad or m]. currents: likewise [drive unit]. rate: sampling
    rate [Hz]. velocity_noise: of each recording, the noise density of every logged velocity that is used
    [unit^2/s^2/Hz], shape (n,), infinite for the others.
    """
    if not positions or len(positions) != len(currents):
        raise BenchError(f"filter settings: {len(positions)} positions, {len(currents)} currents: want pairs")
    current_band = motion_band = 0.0
    limits: list[tuple[float, float]] = []
    position_noise: list[FloatArray] = []
    current_noise: list[FloatArray] = []
    if velocity_noise is None:
        velocity_noise = [np.full(position.shape[1], np.inf) for position in positions]
    for position, current, logged in zip(positions, currents, velocity_noise, strict=True):
        frequency, density = power_spectrum(current, rate)
        floor = noise_density(current, rate)
        current_noise.append(floor)
        density = signal_density(density, floor)
        live = density.sum(axis=0) * frequency[1] > BANDS.alive * floor * rate / 2
        current_band = max(current_band, band_edge(frequency, density * live, BANDS.current_loss))

        frequency, density = power_spectrum(position, rate)
        floor = np.maximum(noise_density(position, rate), quantisation_density(position, rate))
        position_noise.append(floor)
        density = leading_signal_density(density, floor)
        ends = noise_from(frequency, density)
        density = np.where(frequency[:, None] < ends, density, 0.0)
        live = density.sum(axis=0) * frequency[1] > BANDS.moves * floor * rate / 2
        acceleration = (2 * np.pi * frequency[:, None]) ** 4 * density * live
        motion_band = max(motion_band, band_edge(frequency, acceleration, BANDS.motion_loss))
        power = acceleration.sum(axis=0) * frequency[1]
        fit, wide = (
            _noise_limit(power, floor, logged, share) for share in (BANDS.fit_noise, BANDS.filter_noise)
        )
        limits.append((fit, wide))
    return Bands(
        current=current_band,
        motion=motion_band,
        fit_limit=min(limit for limit, _ in limits),
        filter_limit=min(limit for _, limit in limits),
        position_noise=np.max(position_noise, axis=0),
        current_noise=np.max(current_noise, axis=0),
    )


def choose_settings(
    positions: Sequence[FloatArray], currents: Sequence[FloatArray], rate: float, bands: Bands | None = None
) -> FilterSettings:
    """Choose the filters from the spectra of all recordings.

    The fit's band holds the currents except for a thousandth of their power (where Coulomb friction leaves a long tail:
    at most fifteen times the band of the motion) and gives at least 800 rows. It ends earlier where the noise of the
    positions, differentiated twice, would bias the fit (an acceleration whose noise is a share e of its power lowers a
    least-squares inertia by about e), but not before the motion does. The position cut-off is 5 times the band, or down
    to 3.2 times if noise requires it; the attenuation at the edge of the band is then below 1e-4. Source of the rule of
    five: M. Gautier, "Dynamic identification of robots with power model", ICRA 1997.

    positions: one array of shape (N, n) for each recording [rad or m]. currents: likewise [drive unit]. rate: sampling
    rate [Hz]. bands: from `signal_bands` for the same recordings, if known already. Raises BenchError: recordings not
    in pairs, or one of fewer than 100 samples.
    """
    if bands is None:
        bands = signal_bands(positions, currents, rate)
    samples = [len(position) for position in positions]
    wanted = max(min(bands.current, BANDS.harmonics * bands.motion), 0.4 * rate * BANDS.rows / sum(samples))
    band = min(max(min(wanted, bands.fit_limit), bands.motion), BANDS.highest * rate)

    decimation = int(0.4 * rate / band + 1e-9)
    decimation = max(1, min(decimation, min(samples) // BANDS.samples))
    band = min(fit_band(rate, decimation), BANDS.highest * rate)
    cutoff = min(
        max(BANDS.narrowest * band, min(bands.filter_limit, BANDS.widest * band)), BANDS.highest_cutoff * rate
    )
    border = settled_border(cutoff, rate, min(samples))
    return FilterSettings(position_cutoff=cutoff, decimation=decimation, border=(border, border))


def completed(
    given: Mapping[str, Any],
    positions: Sequence[FloatArray],
    currents: Sequence[FloatArray],
    rate: float,
    bands: Bands | None = None,
) -> FilterSettings:
    """Settings of which some are given by name; the others are chosen as in `choose_settings`. The border is that which
    the cut-off, given or chosen, needs.
    """
    settings = replace(choose_settings(positions, currents, rate, bands), **given)
    if "position_cutoff" not in given or "border" in given:
        return settings
    border = settled_border(settings.position_cutoff, rate, min(len(position) for position in positions))
    return replace(settings, border=(border, border))


def settled_border(cutoff: float, rate: float, samples: int) -> int:
    """Samples until the low-pass on positions has settled from an end, at most a fifth of the shortest log."""
    return min(int(np.ceil(BANDS.settling * rate / cutoff)) + 8, int(BANDS.border * samples))


def _noise_limit(
    acceleration_power: FloatArray, position_noise: FloatArray, velocity_noise: FloatArray, share: float
) -> float:
    # White noise of density s on a position has the power (2 pi)^4 s f^5 / 5 in the acceleration up to f, on a
    # velocity (2 pi)^2 s f^3 / 3.
    moving = (acceleration_power > 0) & (position_noise > 0)
    if not moving.any():
        return np.inf
    power = share * acceleration_power[moving]
    twice = (5 * power / ((2 * np.pi) ** 4 * position_noise[moving])) ** 0.2
    noise = np.maximum(velocity_noise[moving], np.finfo(float).tiny)
    once = np.cbrt(3 * power / ((2 * np.pi) ** 2 * noise))
    return float(np.maximum(twice, once).min())
