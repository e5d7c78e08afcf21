"""Bounds of filters, spectra and bands, by topic."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FilterBlockBounds:
    """Block sizes of filters; samples, unless stated."""

    length: int = 192  # of a block, about: longer ones cost more products, shorter ones more steps
    kept: int = 16  # of a block's samples, at most
    longest: int = 512  # block that is worth its matrices
    together: int = 32768  # that are filtered together
    section: int = 64  # of a block of second-order sections
    sections: int = 8  # blocks whose states are computed together
    # numbers that are transformed together: they stay in the cache of the processor
    transformed: int = 100_000
    # kept samples from the end to where the start returns: the filter has forgotten by then
    forgotten: int = 40
    factors: tuple[int, ...] = (2, 3, 5)  # of lengths for which a Fourier transform is quick
    neighbours: int = 4  # for interpolation between or outside them


@dataclass(frozen=True)
class DecimationBounds:
    """The low-pass before decimation: Chebyshev, forwards and backwards."""

    order: int = 8  # of one pass
    ripple: float = 0.05  # dB, of one pass
    band: float = 0.8  # cut-off as a share of half the new rate


@dataclass(frozen=True)
class LoggedVelocityBounds:
    """Whether a logged velocity is that of the positions."""

    agrees: float = 2e-3  # RMS share of the velocity by which the logged one may differ, noise aside
    noise: float = 2.0  # times the noise power: a smaller difference is not significant
    # share of the positions' noise in the acceleration: a logged velocity with less is used
    quieter: float = 0.5
    unit: float = 0.02  # relative difference from a unit's factor, for a velocity that may be in this unit


@dataclass(frozen=True)
class ReturningBounds:
    """Whether a motion returns; shares of the standard deviation of a position, unless stated."""

    same: float = 0.1  # distance of a returning motion from the first period
    mostly: float = 0.5  # least share of the samples: between a separate start and stop
    other: float = 0.5  # distance in between, at least
    near: float = 1.0  # distance at a lag that is examined
    samples: int = 30  # that must occur a second time, at least
    # of a sample, in which a period is sought, the second about the best of the first
    steps: tuple[float, ...] = (0.25, 0.05)


@dataclass(frozen=True)
class BandBounds:
    """The choice of the filters from the spectra."""

    current_loss: float = 1e-3  # share of a current's power that may lie above the fit's band
    motion_loss: float = 1e-2  # the same for an acceleration, where noise requires a narrow band
    fit_noise: float = 1e-5  # power of an acceleration's noise within the band, as a share of its signal
    filter_noise: float = 1e-3  # the same before decimation, up to the position cut-off
    alive: float = 0.1  # signal over noise of a current, in power: with less it does not count
    moves: float = 100.0  # the same of a position: ten times its noise
    widest: float = 5.0  # position cut-off as a multiple of the band, as in Gautier's practice
    narrowest: float = 3.2  # the same: attenuation at the edge of the band is then 1e-4
    harmonics: float = 15.0  # times the band of the motion, at most: steps of friction have no band
    highest: float = 0.1  # share of the rate: central differences of order 8 are then exact to 1e-4
    highest_cutoff: float = 0.4  # share of the rate
    rows: int = 800  # decimated samples of all recordings, unless noise requires a narrower band
    samples: int = 50  # decimated samples of the shortest recording
    border: float = 0.2  # share of the shortest log, at each of its ends
    settling: float = 5.8  # cut-off periods until the low-pass has settled from an end, to 1e-6


@dataclass(frozen=True)
class SpectrumBounds:
    """The estimate of a spectrum, and of its noise floor."""

    shortest: int = 100  # samples of a record
    segments: int = 3  # part of a record in a segment, of a short record more; they overlap by four fifths
    segment: float = 6.0  # s, the shortest if the record has it: a line is then 1 Hz wide on either side
    # side lobes below -150 dB: the floor of a 20-bit encoder is 130 dB below the motion
    kaiser: float = 20.0
    taps: int = 33  # of the high-pass of a quarter of the rate, by the window method
    taper: float = 12.0  # of that window
    neighbours: int = 10  # samples omitted on either side of an outlier
    clip: float = 4.0  # standard deviations; white noise passes except for 6 samples in 100,000
    lobe: int = 13  # frequencies over which such a window smears a line
    faded: float = 100.0  # factor by which an acceleration has fallen where its motion ends
    risen: float = 3.0  # factor by which it rises where noise begins
    level: float = 30.0  # factor by which it has fallen at level noise
    level_ratio: float = 4.0  # of frequencies over which noise is level
    # factor by which an acceleration of bodies falls to the end of the spectrum, at least
    falls: float = 3.0
    outlier: float = 3.0  # times the floor: a density above is a signal, not noise


BLOCKS = FilterBlockBounds()
DECIMATING = DecimationBounds()
LOGGED = LoggedVelocityBounds()
RETURNING = ReturningBounds()
BANDS = BandBounds()
SPECTRA = SpectrumBounds()
