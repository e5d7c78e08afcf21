"""Zero-phase low-pass filter of measured joint positions.

Source: the band-pass differentiation of M. Gautier, "Dynamic identification of robots with power model",
ICRA 1997: a Butterworth filter run forward and backward, followed by central differences. The ends are
extended as MATLAB's `filtfilt` does, so that published results can be repeated to the last digit.

A section (b0, b1, b2, 1, a1, a2) is the difference equation y(k) = b0 x(k) + b1 x(k-1) + b2 x(k-2) - a1 y(k-1) -
a2 y(k-2); sections run one after the other. Source: A. V. Oppenheim and R. W. Schafer, "Discrete-Time Signal
Processing", 2010, chapters 6 and 7. scipy.signal has the same, and takes half a second to import.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.signals.bounds import BLOCKS

FloatArray = NDArray[np.float64]


def butterworth(order: int, cutoff: float) -> FloatArray:
    """Low-pass (n_sections, 6) of maximal flatness; cutoff: its half-power frequency over half the rate."""
    angle = np.pi * np.arange(-order + 1, order, 2) / (2 * order)
    return _digital(-np.exp(1j * angle), 1.0, cutoff)


def chebyshev(order: int, ripple: float, cutoff: float) -> FloatArray:
    """Low-pass (n_sections, 6) of type I; ripple: dB below the cut-off, given over half the rate."""
    epsilon = np.sqrt(10.0 ** (0.1 * ripple) - 1.0)
    angle = np.pi * np.arange(-order + 1, order, 2) / (2 * order)
    poles = -np.sinh(np.arcsinh(1.0 / epsilon) / order + 1j * angle)
    return _digital(poles, 1.0 if order % 2 else 1.0 / np.sqrt(1.0 + epsilon**2), cutoff)


def _digital(poles: NDArray[np.complex128], gain: float, cutoff: float) -> FloatArray:
    """Sections of an analogue low-pass without zeros, by the bilinear transform; gain: at 0 Hz.

    The poles next to the unit circle come last; every section but the first passes a constant unchanged.
    """
    scaled = poles * np.tan(0.5 * np.pi * cutoff)
    scaled = scaled[scaled.imag > -1e-12]
    share = scaled / (scaled - 1.0)  # (1 - pole) / 2, which rounding would lose in a pole near one
    upper = (1.0 + scaled) / (1.0 - scaled)
    sections = np.zeros((len(upper), 6))
    for section, k in zip(sections, np.argsort(np.abs(upper)), strict=True):
        re, im = float(upper[k].real), float(upper[k].imag)
        if im > 1e-12:
            section[:] = (1.0, 2.0, 1.0, 1.0, -2.0 * re, re * re + im * im)
            section[:3] *= abs(share[k]) ** 2
        else:
            section[:] = (1.0, 1.0, 0.0, 1.0, -re, 0.0)
            section[:3] *= share[k].real
    sections[0, :3] *= gain
    return sections


def at_rest(sections: FloatArray) -> FloatArray:
    """States (n_sections, 2) of sections settled on an input of one."""
    states, value = np.empty((len(sections), 2)), 1.0
    for state, (b0, b1, b2, _, a1, a2) in zip(states, sections, strict=True):
        after = value * (b0 + b1 + b2) / (1.0 + a1 + a2)
        state[1] = b2 * value - a2 * after
        state[0] = b1 * value - a1 * after + state[1]
        value = after
    return states


def response(sections: FloatArray, angle: FloatArray) -> NDArray[np.complex128]:
    """Complex gain at angles (N,), rad/sample."""
    back = np.exp(-1j * np.asarray(angle))
    powers = np.stack((np.ones_like(back), back, back * back))
    return np.asarray(np.prod((sections[:, :3] @ powers) / (sections[:, 3:] @ powers), axis=0))


def filtered(sections: FloatArray, x: FloatArray, states: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Samples x (N, ...) filtered by sections from states (n_sections, 2, ...): outputs and last states.

    Many samples are processed block by block: a block's outputs and last states are constant matrices times its samples
    and first states, so only states are carried sequentially.
    """
    columns = x.reshape(len(x), states[0, 0].size)
    state = states.reshape(2 * len(sections), states[0, 0].size)
    outputs = np.empty(columns.shape)
    length = BLOCKS.section
    count = len(x) // length
    at = count * length
    if count:
        matrices = _block(sections.tobytes())
        blocks = columns[:at].reshape(count, length, -1).transpose(1, 0, 2).reshape(length, -1)
        given = (matrices.fed @ blocks).reshape(len(state), count, -1).transpose(1, 0, 2)
        begins, state = carried(matrices.carry, state, given)
        forced = matrices.filtered @ blocks + matrices.initial @ begins.transpose(1, 0, 2).reshape(
            len(state), -1
        )
        outputs[:at] = forced.reshape(length, count, -1).transpose(1, 0, 2).reshape(at, -1)
    rest = len(x) - at
    if rest:
        matrices, given = _block(sections.tobytes()), columns[at:]
        outputs[at:] = matrices.filtered[:rest, :rest] @ given + matrices.initial[:rest] @ state
        state = matrices.powers[rest] @ state + matrices.fed[:, length - rest :] @ given
    return outputs.reshape(x.shape), state.reshape(states.shape)


def carried(carry: FloatArray, state: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
    """States (B, s, K) at which blocks begin, and the last one's end, from what each block adds (B, s, K).

    Several blocks at a time, by one product: what every block adds to the later states.
    """
    blocks, size, columns = given.shape
    states = np.empty((blocks, size, columns))
    whole = blocks - blocks % BLOCKS.sections
    if whole:
        ahead, alone = _over_blocks(carry.tobytes(), size)
        added = given[:whole].reshape(-1, BLOCKS.sections * size, columns)
        added = alone @ added
        groups = states[:whole].reshape(-1, BLOCKS.sections * size, columns)
        for target, more in zip(groups, added, strict=True):
            every = ahead @ state
            every += more
            target[:size], target[size:] = state, every[:-size]
            state = every[-size:]
    for target, more in zip(states[whole:], given[whole:], strict=True):
        target[:] = state
        state = carry @ state + more
    return states, state


@lru_cache(maxsize=64)
def _over_blocks(key: bytes, size: int) -> tuple[FloatArray, FloatArray]:
    """Maps the state before some blocks (T s, s), and their additions (T s, T s), to the states after each."""
    carry = np.frombuffer(key).reshape(size, size).astype(np.longdouble)
    powers = [np.eye(size, dtype=np.longdouble)]
    for _ in range(BLOCKS.sections):
        powers.append(carry @ powers[-1])
    alone = np.zeros((BLOCKS.sections, size, BLOCKS.sections, size))
    for behind in range(BLOCKS.sections):
        for block in range(behind + 1):
            alone[behind, :, block] = powers[behind - block]
    return np.concatenate(powers[1:]).astype(float), alone.reshape(BLOCKS.sections * size, -1)


def one_by_one(sections: FloatArray, columns: FloatArray, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The same, sample by sample: columns (N, K), state (2 n_sections, K)."""
    outputs, state = np.array(columns), np.array(state)
    for i, (b0, b1, b2, _, a1, a2) in enumerate(sections.tolist()):
        first, second = state[2 * i], state[2 * i + 1]
        for k, given in enumerate(outputs.copy()):
            passed = b0 * given + first
            first = b1 * given - a1 * passed + second
            second = b2 * given - a2 * passed
            outputs[k] = passed
        state[2 * i], state[2 * i + 1] = first, second
    return outputs, state


@dataclass(frozen=True)
class _Block:
    """Of L samples, s states: filtered (L, L), initial (L, s) give outputs; fed (s, L), carry (s, s) give last states.

    powers (L, s, s): carry over fewer samples.
    """

    filtered: FloatArray
    initial: FloatArray
    fed: FloatArray
    carry: FloatArray
    powers: FloatArray


@lru_cache(maxsize=64)
def _block(key: bytes) -> _Block:
    sections = np.frombuffer(key).reshape(-1, 6)
    size = 2 * len(sections)
    # Every column a separate run: a unit impulse at each sample, then a unit of each state.
    length = BLOCKS.section
    impulses = np.concatenate((np.eye(length), np.zeros((length, size))), axis=1)
    states = np.concatenate((np.zeros((size, length)), np.eye(size)), axis=1)
    outputs, after = one_by_one(sections, impulses, states)
    step = one_by_one(sections, np.zeros((1, size)), np.eye(size))[1]
    powers = np.stack([np.linalg.matrix_power(step, k) for k in range(length)])
    return _Block(outputs[:, :length], outputs[:, length:], after[:, :length], after[:, length:], powers)


def low_pass(x: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Return x without frequencies above the cut-off, in phase.

    A Butterworth filter runs forward and then backward along axis 0, so its gain is squared:
    1 / (1 + (tan(pi f / rate) / tan(pi cutoff / rate))^(2 order)), one half at the cut-off. Both ends are
    extended by 3 * order samples, reflected through the end points.

    x: samples, shape (N, ...), any unit; every column is filtered alike. rate: sampling rate [Hz]. cutoff: cut-off
    frequency [Hz], below half the sampling rate. order: order of one pass. Raises BenchError: the cut-off is not
    between 0 and half the sampling rate, or the record is too short.
    """
    if order < 1:
        raise BenchError(f"low-pass filter: order {order} must be at least 1")
    if not 0 < cutoff < rate / 2:
        raise BenchError(
            f"low-pass filter: cut-off {cutoff:g} Hz must lie between 0 and {rate / 2:g} Hz, "
            f"half the sampling rate of {rate:g} Hz"
        )
    return forward_backward(_butterworth(order, 2.0 * cutoff / rate), x, order, "low-pass filter")


def low_pass_gain(frequency: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Return the gain of `low_pass` (forward and backward together) at frequencies [Hz] up to rate / 2."""
    warped = np.tan(np.pi * np.asarray(frequency) / rate) / np.tan(np.pi * cutoff / rate)
    return np.asarray(1 / (1 + warped ** (2 * order)), dtype=float)


def forward_backward(sections: FloatArray, x: FloatArray, order: int, what: str) -> FloatArray:
    """Run second-order sections forward and backward along axis 0, ends extended by 3 * order samples.

    Second-order sections are more accurate than one ratio of polynomials: at a cut-off of a twelfth of the rate, the
    two already differ by 2e-8, and more at lower cut-offs.

    sections: shape (n_sections, 6). x: samples, shape (N, ...). order: order of the filter, which sets the length of
    the extension. what: name of the caller for the message. Raises BenchError: the record has no more than 3 * order
    samples.
    """
    x = np.asarray(x, dtype=float)
    check_length(x, order, what)
    start = resting_states(sections.tobytes())[(..., *(None,) * (x.ndim - 1))]
    way = extended_end(extended_start(x, 3 * order), 3 * order)
    for _ in range(2):
        way = filtered(sections, way, start * way[0])[0][::-1]
    return np.ascontiguousarray(way[3 * order : len(way) - 3 * order])


def check_length(x: FloatArray, order: int, what: str) -> None:
    """Raise BenchError if a record (N, ...) is too short for the extension of a filter of this order."""
    if len(x) <= 3 * order:
        raise too_short(len(x), order, what)


def too_short(length: int, order: int, what: str) -> BenchError:
    """Message for a record of `length` samples."""
    return BenchError(f"{what}: {length} samples are too few, it needs more than {3 * order}")


def extended_start(x: FloatArray, length: int, held: int = 0) -> FloatArray:
    """Return x, shape (N, ...), with `length` more samples before it, reflected through the first one.

    held: number of further samples before these, equal to the first of them.
    """
    start = held + length
    extended = np.empty((start + len(x), *x.shape[1:]))
    extended[start:] = x
    np.subtract(2 * x[0], x[length:0:-1], out=extended[held:start])
    extended[:held] = extended[held]
    return extended


def extended_end(x: FloatArray, length: int) -> FloatArray:
    """Return x, shape (N, ...), with `length` samples more after it, reflected in the last one."""
    extended = np.empty((len(x) + length, *x.shape[1:]))
    extended[: len(x)] = x
    np.subtract(2 * x[-1], x[-2 : -length - 2 : -1], out=extended[len(x) :])
    return extended


@lru_cache(maxsize=64)
def _butterworth(order: int, cutoff: float) -> FloatArray:
    """Second-order sections of a low-pass, its cut-off as a share of half the rate."""
    return butterworth(order, cutoff)


@lru_cache(maxsize=64)
def resting_states(sections: bytes) -> FloatArray:
    """States (n_sections, 2) of second-order sections settled on an input of one."""
    return at_rest(np.frombuffer(sections).reshape(-1, 6))
