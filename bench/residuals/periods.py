"""The error's spectrum over time and over position."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.residuals.autocorrelation import independent_rows
from bench.residuals.bounds import ERROR_GRID, NAMING
from bench.residuals.motor import MotorSeries
from bench.signals.spectrum import hann_spectrum


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Spectrum over time. frequency (F,) Hz; density (F,): of the error, drive unit² per Hz; noise: of the current."""

    frequency: np.ndarray
    density: np.ndarray
    noise: float


@dataclass(frozen=True, eq=False)
class PositionSpectrum:
    """cycles (K,) per rad or m; of the best sinusoid amplitude, drive unit, and share of the squared error, (K,)."""

    cycles: np.ndarray
    amplitude: np.ndarray
    share: np.ndarray


@dataclass(frozen=True)
class SpectralLine:
    """A line. frequency: cycles per rad, m or s; amplitude: drive unit.

    resolution: half a cycle in the travelled range or in the recording, within which the frequency is known.
    """

    joint: str
    over: Literal["time", "position"]
    frequency: float
    error_share: float
    amplitude: float
    resolution: float


def time_spectrum(series: Sequence[MotorSeries]) -> Spectrum:
    """Welch's spectrum of one motor's error, averaged over its recordings; errors are zero at rest."""
    length = min(ERROR_GRID.segment, *(int(trace.row[-1] - trace.row[0]) + 1 for trace in series))
    densities, weights = [], []
    for trace in series:
        filled = np.zeros(int(trace.row[-1] - trace.row[0]) + 1)
        filled[trace.row - trace.row[0]] = trace.error
        frequency, density = hann_spectrum(filled, trace.rate, length, centred=False)
        densities.append(density * len(filled) / len(trace.row))
        weights.append(len(trace.row))
    noise = np.average([motor_trace.noise**2 / motor_trace.band for motor_trace in series], weights=weights)
    return Spectrum(frequency, np.average(densities, axis=0, weights=weights), float(noise))


def position_spectrum(series: Sequence[MotorSeries]) -> PositionSpectrum:
    """Amplitude of the best sinusoid over position, for every wave number that motion and filters can show."""
    position = np.concatenate([trace.position for trace in series])
    error = np.concatenate([trace.error for trace in series])
    speed = float(np.sqrt(np.mean(np.concatenate([trace.velocity for trace in series]) ** 2)))
    finest = max(trace.rate for trace in series) / max(speed, 1e-12)
    cycles = _grid(float(np.ptp(position)), finest)
    amplitude, share = _sinusoids(position, error, cycles)
    return PositionSpectrum(cycles, amplitude, share)


def lines(series: Sequence[MotorSeries]) -> list[SpectralLine]:
    """Lines in one motor's error far beyond chance, at most one over position and one over time."""
    count = independent_rows(series, [trace.error for trace in series])
    spectral = []
    over_position = position_spectrum(series)
    position = np.concatenate([trace.position for trace in series])
    travel = float(np.ptp(position))
    least = ERROR_GRID.cycles / max(travel, 1e-12)
    best = _strongest(over_position.cycles, over_position.share, least, count, 2)
    if best is not None:
        error = np.concatenate([trace.error for trace in series])
        finer = _about(over_position.cycles[best], travel)
        amplitude, share = _sinusoids(position, error, finer)
        spectral.append(_line(series[0].joint, "position", finer, share, amplitude, travel))
    in_time = _time_line(series, count)
    return [*spectral, *([in_time] if in_time else [])]


def _time_line(series: Sequence[MotorSeries], independent: float) -> SpectralLine | None:
    duration = min(float(np.ptp(trace.time)) for trace in series)
    if duration <= 0:
        return None
    frequency = _grid(duration, series[0].rate / 2.0)

    def shares(values: Sequence[np.ndarray], grid: np.ndarray = frequency) -> tuple[np.ndarray, np.ndarray]:
        whole = sum(float(column @ column) for column in values)
        taken, amplitude = np.zeros(len(grid)), np.zeros(len(grid))
        for trace, value in zip(series, values, strict=True):
            sizes, share = _sinusoids(trace.time, value, grid)
            taken += share * float(value @ value)
            amplitude += sizes**2 / len(series)
        return np.sqrt(amplitude), taken / whole if whole else taken

    errors = [trace.error for trace in series]
    _, share = shares(errors)
    _, of_motion = shares([trace.measured for trace in series])
    _, of_speed = shares([trace.velocity for trace in series])
    of_time = np.where(np.maximum(of_motion, of_speed) < NAMING.line_of_motion * share, share, 0.0)
    best = _strongest(frequency, of_time, ERROR_GRID.cycles / duration, independent, 2 * len(series))
    if best is None:
        return None
    finer = _about(frequency[best], duration)
    amplitude, share = shares(errors, finer)
    return _line(series[0].joint, "time", finer, share, amplitude, duration)


def _about(frequency: float, extent: float) -> np.ndarray:
    """Frequencies between the neighbours of one on the grid."""
    return np.asarray(
        frequency + np.linspace(-1.0, 1.0, ERROR_GRID.finer) / (ERROR_GRID.oversampling * extent)
    )


def _line(
    joint: str,
    over: Literal["time", "position"],
    frequency: np.ndarray,
    share: np.ndarray,
    amplitude: np.ndarray,
    extent: float,
) -> SpectralLine:
    best = int(np.argmax(share))
    strongest, taken, size = (float(values[best]) for values in (frequency, share, amplitude))
    return SpectralLine(joint, over, strongest, taken, size, 0.5 / extent)


def _grid(extent: float, finest: float) -> np.ndarray:
    """Frequencies from one cycle in the extent up to `finest`, half a cycle in the extent apart."""
    step = 1.0 / (ERROR_GRID.oversampling * max(extent, 1e-12))
    count = int(np.clip(finest / step, 1, ERROR_GRID.frequencies))
    return step * np.arange(ERROR_GRID.oversampling, max(count, ERROR_GRID.oversampling) + 1)


def _sinusoids(x: np.ndarray, values: np.ndarray, frequencies: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least-squares sinusoid of every frequency: amplitude (K,), and its share of the squares (K,).

    frequencies: evenly spaced, so that few exponentials give all by their products.
    Source: Lomb, "Least-squares frequency analysis of unequally spaced data", 1976.
    """
    count = len(frequencies)
    width = int(np.ceil(np.sqrt(count)))
    step = float(frequencies[1] - frequencies[0]) if count > 1 else 0.0
    turn = 2.0j * np.pi * x
    coarse = np.exp(np.outer(frequencies[::width], turn))
    fine = np.exp(np.outer(step * np.arange(width), turn)).T
    sums = ((coarse * values) @ fine).reshape(-1)[:count]
    squares = ((coarse * coarse) @ (fine * fine)).reshape(-1)[:count]
    cc, ss = (len(x) + squares.real) / 2.0, (len(x) - squares.real) / 2.0
    cs = squares.imag / 2.0
    pc, ps = sums.real, sums.imag
    det = np.maximum(cc * ss - cs**2, 1e-9 * len(x) ** 2)
    a, b = (ss * pc - cs * ps) / det, (cc * ps - cs * pc) / det
    whole = float(values @ values)
    share = np.clip((a * pc + b * ps) / whole, 0.0, 1.0) if whole else np.zeros(len(frequencies))
    return np.hypot(a, b), share


def _strongest(
    frequency: np.ndarray, share: np.ndarray, least: float, independent: float, freedom: int
) -> int | None:
    """The strongest line from frequency `least` on, if beyond chance and large enough."""
    allowed = np.where(frequency >= least, share, 0.0)
    best = int(np.argmax(allowed))
    if allowed[best] < NAMING.line:
        return None
    # twice the log-likelihood ratio is about chi-squared; its tail falls like exp(-x / 2)
    surprise = -independent / 2.0 * np.log(1.0 - min(float(allowed[best]), 1.0 - 1e-12))
    certain = -np.log(NAMING.chance / len(frequency)) + freedom
    return best if surprise > certain else None
