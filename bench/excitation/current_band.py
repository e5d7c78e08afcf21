"""The band of the currents that a motion requires, compared with the band of the motion.

The fit opens its filters as wide as the currents need (`bench.signals.settings`), and the encoder noise of
accelerations that passes them grows with the power 5/2 of the band. A narrow current peak, as near a singular pose,
therefore costs more than it is worth: the errors of encoders, and of a simulation's time steps, exceed the noise of the
currents.
"""

import numpy as np

from bench.excitation.bounds import DESIGN
from bench.scenario.trajectory import FourierTrajectory
from bench.signals.bounds import BANDS


def current_above(
    current: np.ndarray, rate: float, trajectory: FourierTrajectory
) -> tuple[np.ndarray, np.ndarray]:
    """Currents or torques (N, n) about their mean, at a rate in Hz, in Hann's window, and their part above
    `DESIGN.current_band` times the highest harmonic, (N, n) each.
    """
    whole = hann(len(current))[:, None] * (current - current.mean(axis=0))
    spectrum = np.fft.rfft(whole, axis=0)
    frequency = np.fft.rfftfreq(len(whole), 1.0 / rate)
    spectrum[frequency <= DESIGN.current_band * trajectory.harmonics * trajectory.base_frequency] = 0.0
    return whole, np.fft.irfft(spectrum, len(whole), axis=0)


def band_shares(current: np.ndarray, rate: float, trajectory: FourierTrajectory) -> np.ndarray:
    """RMS of each current (N, n) above the band, as a share (n,) of the allowed RMS: at most 1.

    The fit allows `BANDS.current_loss` of the power above its band.
    """
    whole, above = current_above(current, rate, trajectory)
    power = (whole**2).sum(axis=0)
    allowed = BANDS.current_loss * np.where(power > DESIGN.steady * (current**2).sum(axis=0), power, np.inf)
    return np.asarray(np.sqrt((above**2).sum(axis=0) / allowed))


def hann(length: int) -> np.ndarray:
    """Hann's window (length,)."""
    return np.asarray(np.hanning(length + 1)[:-1])
