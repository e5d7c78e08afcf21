"""The decimation of columns that are known at every so many-th sample only, and smooth between these.

The filter is that of `bench.signals.decimation.decimate`, by its gain at every frequency. What it lets pass is known
from few samples as well, as long as these follow each other several times faster than those that it keeps.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import gcd

import numpy as np
from numpy.typing import NDArray

from bench.signals.bounds import BLOCKS, DECIMATING
from bench.signals.decimation import FloatArray, decimated_indices, sections_of
from bench.signals.sections import response


@dataclass(frozen=True)
class _Plan:
    """How columns of K samples are filtered: as `size` samples that repeat.

    front (b, t), back (b, t): the samples before the first and after the last sample, from the first t and the last t;
    behind both it stays as it is. forward, backward: gains at the frequencies of both passes; kept: how many samples of
    twice the rate of those that are kept come out of the second, and the first `count` of every other are those.
    """

    size: int
    front: FloatArray
    back: FloatArray
    forward: NDArray[np.complex128]
    backward: NDArray[np.complex128]
    kept: int
    count: int


def decimate_sparse(x: FloatArray, every: int, length: int, factor: int) -> FloatArray:
    """What `decimate` gives of so many samples, of which x (K, C) has every so many-th from the first one on.

    factor: more than twice `every`; x has at least 3 * order / every + neighbours samples. Returns (M, C).
    """
    plan = _plan(every, length, factor)
    rows = np.empty((plan.count, x.shape[1]))
    most = max(1, BLOCKS.transformed // plan.size)
    for at in range(0, x.shape[1], most):
        rows[:, at : at + most] = _decimated(plan, np.ascontiguousarray(x[:, at : at + most].T)).T
    return rows


def _decimated(plan: _Plan, columns: FloatArray) -> FloatArray:
    """Columns (C, K) at the samples that are kept, (C, M)."""
    front = columns[:, : plan.front.shape[1]] @ plan.front.T
    back = columns[:, -plan.back.shape[1] :] @ plan.back.T
    whole = np.concatenate((front, columns, back), axis=1)
    passed = np.fft.irfft(np.fft.rfft(_closed(whole, plan.size)) * plan.forward, n=plan.size)
    spectrum = np.fft.rfft(_closed(passed[:, : whole.shape[1]], plan.size))
    kept = np.fft.irfft(spectrum[:, : len(plan.backward)] * plan.backward, n=plan.kept)
    return np.asarray(kept[:, : 2 * plan.count : 2])


def _closed(columns: FloatArray, size: int) -> FloatArray:
    """Columns (C, K), and after them a way from the last to the first value: level, smooth, level; (C, size)."""
    more = size - columns.shape[1]
    share = 0.5 - 0.5 * np.cos(np.pi * np.linspace(-1.0, 2.0, more).clip(0.0, 1.0))
    last = columns[:, -1:]
    return np.concatenate((columns, last + (columns[:, :1] - last) * share), axis=1)


@lru_cache(maxsize=64)
def _plan(every: int, length: int, factor: int) -> _Plan:
    count = -(-length // every)
    extension = 3 * DECIMATING.order
    offsets = np.arange(1, -(-extension // every) + 1)
    before = np.minimum(offsets * every, extension) / every
    nodes = -(-extension // every) + BLOCKS.neighbours + 1
    front = 2.0 * _between(np.zeros(len(offsets)), nodes) - _between(before, nodes)
    # counted from the last known sample backwards, in their steps, as the last of all is beyond it
    last = (count - 1) - (length - 1) / every
    after = np.minimum(offsets + last, extension / every)
    back = 2.0 * _between(np.full(len(offsets), last), nodes) - _between(last + after, nodes)
    common = every * factor // gcd(every, factor)
    repeats = -(-(length + 2 * extension + 2 * every + BLOCKS.forgotten * factor) // common)
    while not _quick(repeats):
        repeats += 1
    period = repeats * common
    size, kept = period // every, 2 * (period // factor)
    angle = 2.0 * np.pi * np.arange(size // 2 + 1) / period
    forward = response(sections_of(factor), angle)
    first = int(decimated_indices(length, factor)[0]) + len(offsets) * every
    backward = forward.conj() * np.exp(1j * angle * first) * (kept / size)
    rows = len(decimated_indices(length, factor))
    return _Plan(size, front[::-1], back[:, ::-1], forward, backward[: kept // 2 + 1], kept, rows)


def _between(places: FloatArray, nodes: int) -> FloatArray:
    """Weights (b, t) of samples 0 to t - 1 at places (b,) between or outside them: the cubic through the nearest."""
    weights = np.zeros((len(places), nodes))
    for row, place in zip(weights, places, strict=True):
        first = max(int(np.floor(place)) - 1, 0)
        for i in range(BLOCKS.neighbours):
            others = first + np.array([k for k in range(BLOCKS.neighbours) if k != i])
            row[first + i] = np.prod((place - others) / (first + i - others))
    return weights


def _quick(number: int) -> bool:
    for factor in BLOCKS.factors:
        while number % factor == 0:
            number //= factor
    return number == 1
