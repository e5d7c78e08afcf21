"""Parallel filtering: the same decimation for all columns of a linear model.

The identification model is y = W chi. Filtering y and every column of W by the same linear filter keeps
chi; so a low-pass that removes the noise above the band of the motion, and dropping the samples that are
then redundant, cost nothing. Source: M. Gautier, "Dynamic identification of robots with power model",
ICRA 1997; W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots", 2002, chapter 12.
The filter is the one of MATLAB's `decimate`, with which the EMPS results were published.

Filter and decimation work block by block. A filter with state s maps a block of samples x to outputs T x + O s and to
the state F x + P s. So does its backward run over those outputs, and both together: constant matrices map x to the few
samples that are kept, for many blocks at once. Only the states are carried from block to block. The results equal those
of a run sample by sample, except for rounding.

Smooth columns that are known only at thinned samples are filtered by the gain at every frequency. Few samples determine
the pass band, too, if their rate is several times that of the kept samples.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import gcd

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.bounds import BLOCKS, DECIMATING
from bench.signals.filtering import (
    carried,
    chebyshev,
    check_length,
    extended_end,
    extended_start,
    filtered,
    one_by_one,
    response,
    resting_states,
    too_short,
)

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class _Blocks:
    """Matrices of one block of L samples of which every `factor`-th is kept, starting with the first.

    carry (s, s): both states over a block; taken (2 s + kept, L): from the samples to the states of the forward and the
    backward run and to the kept outputs; turned (s, s): from the forward to the backward state; ahead, behind (kept,
    s): from the forward and the backward state to kept outputs.
    """

    length: int
    carry: FloatArray
    taken: FloatArray
    turned: FloatArray
    ahead: FloatArray
    behind: FloatArray


def block_length(factor: int) -> int:
    """Samples of a block, a multiple of the factor; 0 if blocks do not save time."""
    kept = min(max(-(-BLOCKS.length // factor), 1), BLOCKS.kept)
    return kept * factor if kept * factor <= BLOCKS.longest else 0


class RunningFilter:
    """Forward and backward run over samples that come in parts, with decimation; see `kept_samples`.

    Of each block only the states and kept outputs stay for the backward run, not its samples.
    """

    def __init__(self, sections: FloatArray, order: int, factor: int, first: int) -> None:
        self._sections, self._factor, self._extension = sections, factor, 3 * order
        # The forward run begins at rest on the very first sample: repeating that one changes nothing.
        self._front = -(self._extension + first) % factor
        self._start = (self._front + self._extension + first) // factor
        self._first = first
        self._count = 0
        self._waiting: list[FloatArray] = []
        self._begun = False
        self._state: FloatArray = np.zeros(0)
        self._passed: list[FloatArray] = []
        self._kept: list[FloatArray] = []

    def push(self, x: FloatArray) -> None:
        """Take the next samples (K, C)."""
        self._count += len(x)
        self._waiting.append(x)
        length, held = block_length(self._factor), sum(map(len, self._waiting))
        if held <= 2 * self._extension + length or not length:
            return
        waiting = np.concatenate(self._waiting) if len(self._waiting) > 1 else x
        if not self._begun:
            waiting = self._begin(waiting)
        # The last samples are kept, to extend the end; those of an incomplete block wait.
        self._waiting = [waiting[self._run(waiting, len(waiting) - self._extension - 1) :].copy()]

    def finish(self) -> FloatArray:
        """The kept samples (M, C) of all parts, once there are no more."""
        resting = resting_states(self._sections.tobytes())
        way = np.concatenate(self._waiting)
        if not self._begun:
            way = self._begin(way)
        way = extended_end(way, self._extension)
        # Less than a whole block remains to run sample by sample, and at least one sample: it has the last output.
        way = way[self._run(way, len(way) - 1) :]
        columns = way.shape[1]
        state = self._state.reshape(*resting.shape, columns)
        end, _ = filtered(self._sections, way, state)
        initial = resting[:, :, None] * end[-1]
        end, initial = filtered(self._sections, end[::-1], initial)
        kept = [*self._kept, np.asarray(end[::-1][:: self._factor], dtype=float)]
        if self._passed:
            blocks = _blocks(self._sections.tobytes(), self._factor)
            state = initial.reshape(-1, columns)
            for k in reversed(range(len(self._passed))):
                backward, state = carried(blocks.carry, state, self._passed.pop()[::-1])
                whole = kept[k].reshape(len(backward), -1, columns)
                whole += blocks.behind @ backward[::-1]
        count = -(-(self._count - self._first) // self._factor)
        return np.concatenate(kept)[self._start : self._start + count]

    def _begin(self, x: FloatArray) -> FloatArray:
        """The first samples, extended before them, where the run begins at rest."""
        extended = extended_start(x, self._extension, self._front)
        self._state = resting_states(self._sections.tobytes()).reshape(-1, 1) * extended[0]
        self._begun = True
        return extended

    def _run(self, x: FloatArray, most: int) -> int:
        """Run forward over whole blocks of at most `most` samples, and return their total."""
        length, columns = block_length(self._factor), x.shape[1]
        count = most // length if length else 0
        if count <= 0:
            return 0
        blocks = _blocks(self._sections.tobytes(), self._factor)
        size = len(blocks.carry)
        given = blocks.taken @ x[: count * length].reshape(count, length, columns)
        forward, self._state = carried(blocks.carry, self._state, given[:, :size])
        self._passed.append(given[:, size : 2 * size] + blocks.turned @ forward)
        self._kept.append((given[:, 2 * size :] + blocks.ahead @ forward).reshape(-1, columns))
        return count * length


def kept_samples(sections: FloatArray, x: FloatArray, order: int, factor: int, first: int) -> FloatArray:
    """Result of `forward_backward` at every `factor`-th sample of x (N, ...), from index `first` < `factor`.

    sections: shape (n_sections, 6). x: more than 3 * order samples, shape (N, ...). order: of the filter, which sets
    the length of the extension at the ends. factor: one sample in this many is kept. first: index of the first sample
    kept. Returns shape (ceil((N - first) / factor), ...).
    """
    running = RunningFilter(sections, order, factor, first)
    flat = x.reshape(len(x), -1)
    for rows in range(0, len(x), BLOCKS.together):
        running.push(flat[rows : rows + BLOCKS.together])
    kept = running.finish()
    return kept.reshape(len(kept), *x.shape[1:])


@lru_cache(maxsize=64)
def _blocks(key: bytes, factor: int) -> _Blocks:
    sections = np.frombuffer(key).reshape(-1, 6).copy()
    length, size = block_length(factor), 2 * len(sections)
    # Every column a separate run: a unit impulse at each sample, then a unit of each state.
    impulses = np.concatenate((np.eye(length), np.zeros((length, size))), axis=1)
    states = np.concatenate((np.zeros((size, length)), np.eye(size)), axis=1)
    outputs, after = one_by_one(sections, impulses, states)
    passed, initial = outputs[:, :length], outputs[:, length:]
    fed, carry = after[:, :length], after[:, length:]
    back = fed[:, ::-1]
    kept = passed[::-1, ::-1][::factor]
    return _Blocks(
        length=length,
        carry=np.ascontiguousarray(carry),
        taken=np.concatenate((fed, back @ passed, kept @ passed)),
        turned=back @ initial,
        ahead=kept @ initial,
        behind=np.ascontiguousarray(initial[::-1][::factor]),
    )


def decimate(x: FloatArray, factor: int) -> FloatArray:
    """Filter every column alike with zero phase, then keep one sample in `factor`.

    The filter is a Chebyshev type I of order 8, ripple 0.05 dB, cut-off at 0.8 of half the new rate, run
    forward and backward along axis 0. The samples kept end with the last one (see `decimated_indices`).

    x: samples, shape (N, ...). factor: 1 returns a copy of x, unfiltered. Returns shape (ceil(N / factor), ...). Raises
    BenchError: factor below 1, or N not above 24.
    """
    kept = decimated_indices(len(x), factor)
    x = np.asarray(x, dtype=float)
    if factor == 1:
        return np.array(x)
    check_length(x, DECIMATING.order, f"decimation by {factor}")
    return kept_samples(sections_of(factor), x, DECIMATING.order, factor, int(kept[0]))


class Decimation:
    """`decimate` for samples that come in parts: only kept ones are stored."""

    def __init__(self, length: int, factor: int) -> None:
        """length: of all parts together. Raises BenchError as `decimate`."""
        first = int(decimated_indices(length, factor)[0])
        if factor > 1 and length <= 3 * DECIMATING.order:
            raise too_short(length, DECIMATING.order, f"decimation by {factor}")
        self._whole: list[FloatArray] = []
        self._filter = (
            None if factor == 1 else RunningFilter(sections_of(factor), DECIMATING.order, factor, first)
        )

    def push(self, x: FloatArray) -> None:
        """Take the next samples (K, C)."""
        if self._filter is None:
            self._whole.append(x)
        else:
            self._filter.push(x)

    def finish(self) -> FloatArray:
        """All kept samples (M, C), once there are no more."""
        return np.concatenate(self._whole) if self._filter is None else self._filter.finish()


def decimated_indices(length: int, factor: int) -> NDArray[np.intp]:
    """Return which of `length` samples `decimate` keeps, shape (ceil(length / factor),); the last is one."""
    if factor < 1:
        raise BenchError(f"decimation factor {factor} must be at least 1")
    return np.arange((length - 1) % factor, length, factor)


def fit_band(rate: float, factor: int) -> float:
    """Return the highest frequency [Hz] that passes `decimate`, for a sampling rate [Hz] before it."""
    return rate / 2 if factor == 1 else DECIMATING.band * rate / 2 / factor


@lru_cache(maxsize=64)
def noise_bandwidth(factor: int) -> float:
    """Return the share of the variance of white noise that passes `decimate`.

    It is the integral of the squared gain over all frequencies, close to 0.8 / factor.
    """
    if factor == 1:
        return 1.0
    frequency = np.linspace(0, min(2 * DECIMATING.band / factor, 1), 20001)
    h = response(sections_of(factor), np.pi * frequency)
    return float(np.trapezoid(np.abs(h) ** 4, frequency))


@lru_cache(maxsize=64)
def sections_of(factor: int) -> FloatArray:
    """Second-order sections (n_sections, 6) of one pass of the filter of `decimate`."""
    return chebyshev(DECIMATING.order, DECIMATING.ripple, DECIMATING.band / factor)


@dataclass(frozen=True)
class _Plan:
    """How columns of K samples are filtered: as a period of `size` samples.

    front (b, t), back (b, t): extrapolate before the first and after the last sample, from the first t and the last t;
    constant beyond. forward, backward: gains at the frequencies of both passes; kept: number of output samples of the
    second pass, at twice the rate of the kept ones; every other, the first `count`, is kept.
    """

    size: int
    front: FloatArray
    back: FloatArray
    forward: NDArray[np.complex128]
    backward: NDArray[np.complex128]
    kept: int
    count: int


def decimate_sparse(x: FloatArray, every: int, length: int, factor: int) -> FloatArray:
    """The result of `decimate` for `length` samples, of which x (K, C) has one per `every`, from the first.

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
    """Columns (C, K), then a transition from the last to the first value: level, smooth, level; (C, size)."""
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
    """Weights (b, t) of samples 0 to t - 1 at points (b,) between or outside them: cubic through the nearest."""
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
