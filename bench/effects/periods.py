"""Disturbances that repeat with the position: their phase and number of periods."""

from collections.abc import Sequence

import numpy as np

from bench.effects.effect import Bracket, JointSamples, ShapeParameter
from bench.effects.signals import JointSignals

FEWEST = 0.75  # periods within the travel; slower changes look like gravity
FINENESS = 5.0  # search steps per additional period within the travel
MOST_STEPS = 4000
PERIODS = ShapeParameter(
    "periods", "1/{turn}", (4.0, 6.0, 12.0, 24.0, 48.0, 96.0, 192.0), unlike=int(MOST_STEPS / FINENESS)
)
SLOW = 0.2  # of the RMS speed: a joint spends enough time below it
PEAKS = 3
TOGETHER = 500_000  # values of a wave computed at a time: they stay in the processor's cache


def phase(position: np.ndarray, periods: float, rotates: bool) -> np.ndarray:
    """Phase (N,) in rad of a disturbance with `periods` per turn (hinge) or per metre (slide)."""
    return position * periods * (1.0 if rotates else 2.0 * np.pi)


def wave(position: np.ndarray, periods: float, rotates: bool) -> np.ndarray:
    """Cosine and sine of the phase (N, 2)."""
    angle = phase(position, periods, rotates)
    return np.column_stack((np.cos(angle), np.sin(angle)))


def followed_wave(joint: JointSignals, periods: float) -> np.ndarray:
    """The same (N, 2) along a joint's samples, zero where they are too far apart for the wave."""
    seen = joint.follows(phase(joint.position, periods, joint.rotates))
    return wave(joint.position, periods, joint.rotates) * seen[:, None]


def strongest_periods(samples: Sequence[JointSamples], carriers: Sequence[np.ndarray]) -> tuple[Bracket, ...]:
    """The prominent periods of a joint's error: peaks of its least-squares periodogram over position.

    carriers: the factor of the wave for every recording, (M,). A sample counts if the low-pass of the fit passes the
    wave, |rate of the phase| below 2 pi band. In single precision, since the periods are refined afterwards. Source:
    Lomb, "Least-squares frequency analysis of unequally spaced data", Astrophysics and Space Science 39, 1976.
    """
    joint = samples[0]
    turn = _one_in_the_travel(joint)
    rate = (1.0 if joint.rotates else 2.0 * np.pi) * max(SLOW * joint.speed, np.finfo(float).tiny)
    last = max(2.0 * np.pi * joint.band / rate, 4.0 * FEWEST * turn)
    step = turn / FINENESS
    grid = np.arange(FEWEST * turn, last, step)
    grid = grid[:MOST_STEPS]
    explained = np.zeros(len(grid))
    moments = np.zeros((len(grid), 5))
    for sample, carrier in zip(samples, carriers, strict=True):
        size = max(1, TOGETHER // len(sample.position))
        for at in range(0, len(grid), size):
            moments[at : at + size] += _moments(grid[at : at + size], sample, carrier.astype(np.float32))
    cc, cs, ss, ce, se = moments.T
    determinant = cc * ss - cs * cs
    usable = determinant > 1e-6 * cc * ss
    explained[usable] = ((ss * ce * ce - 2.0 * cs * ce * se + cc * se * se)[usable]) / determinant[usable]
    padded = np.concatenate(([-1.0], explained, [-1.0]))
    peaks = np.flatnonzero((explained >= padded[:-2]) & (explained >= padded[2:]))
    best = peaks[np.argsort(explained[peaks])[::-1][:PEAKS]]
    return tuple((float(grid[i] - step), float(grid[i]), float(grid[i] + step)) for i in sorted(best))


def next_to(value: float, samples: Sequence[JointSamples]) -> Bracket:
    """Range of periods about a value, as wide as a periodogram's peak: one more or fewer within the travel."""
    turn = _one_in_the_travel(samples[0])
    return min(value, max(value - turn, FEWEST * turn)), value, value + turn


def _one_in_the_travel(joint: JointSamples) -> float:
    return (2.0 * np.pi if joint.rotates else 1.0) / max(joint.travel, float(np.finfo(float).tiny))


def _moments(grid: np.ndarray, sample: JointSamples, carrier: np.ndarray) -> np.ndarray:
    """Inner products (G, 5) of waves of these periods, with themselves and with the error."""
    angle = np.outer(grid, phase(sample.position, 1.0, sample.rotates)).astype(np.float32)
    pace = np.abs(phase(sample.velocity, 1.0, sample.rotates))
    most = 2.0 * np.pi * sample.band / np.maximum(pace, np.finfo(float).tiny)
    passed = np.where(grid[:, None] < most, carrier, np.float32(0.0))
    cosine, sine = passed * np.cos(angle), passed * np.sin(angle)
    error = sample.error.astype(np.float32)
    pairs = ((cosine, cosine), (cosine, sine), (sine, sine))
    products = [np.einsum("ij,ij->i", pair, other) for pair, other in pairs]
    return np.column_stack((*products, cosine @ error, sine @ error))
