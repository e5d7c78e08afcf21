"""The band of the currents that a motion asks for, held against the band of the motion itself.

The fit opens its filters as wide as the currents need (`bench.signals.settings`), and the noise of the encoders'
accelerations that they then let through grows with the power 5/2 of the band. A narrow peak of the current, as near a
singular pose, therefore costs more than it tells: the errors of encoders, and of the time steps of a simulation, grow
past the noise of the currents.
"""

import numpy as np

from bench.excitation.bounds import DESIGN
from bench.scenario.trajectory import FourierTrajectory
from bench.signals.bounds import BANDS


def current_above(
    current: np.ndarray, rate: float, trajectory: FourierTrajectory
) -> tuple[np.ndarray, np.ndarray]:
    """Currents or torques (N, n) about their mean, at a rate in Hz, in Hann's window, and what of them lies above
    `DESIGN.current_band` times the highest harmonic, (N, n) each.
    """
    whole = hann(len(current))[:, None] * (current - current.mean(axis=0))
    spectrum = np.fft.rfft(whole, axis=0)
    frequency = np.fft.rfftfreq(len(whole), 1.0 / rate)
    spectrum[frequency <= DESIGN.current_band * trajectory.harmonics * trajectory.base_frequency] = 0.0
    return whole, np.fft.irfft(spectrum, len(whole), axis=0)


def band_shares(current: np.ndarray, rate: float, trajectory: FourierTrajectory) -> np.ndarray:
    """How much of the RMS of each current (N, n) lies above the band, as a share of what may (n,): at most 1.

    What may is what the fit lets lie above its band, `BANDS.current_loss` of the power.
    """
    whole, above = current_above(current, rate, trajectory)
    power = (whole**2).sum(axis=0)
    allowed = BANDS.current_loss * np.where(power > DESIGN.steady * (current**2).sum(axis=0), power, np.inf)
    return np.asarray(np.sqrt((above**2).sum(axis=0) / allowed))


def hann(length: int) -> np.ndarray:
    """Hann's window (length,)."""
    return np.asarray(np.hanning(length + 1)[:-1])
