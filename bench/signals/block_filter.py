"""Zero-phase filter and decimation in one: second-order sections, block by block.

A filter with state s takes a block of samples x to outputs T x + O s and to the state F x + P s. So does its run
backward over those outputs, and both together: all that stands between x and the few samples that are kept are
constant matrices, which take many blocks at once. Only the states are carried from block to block. The numbers are
those of the run sample by sample, but for rounding.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from bench.signals.filtering import odd_extension, resting_states

FloatArray = NDArray[np.float64]

LENGTH = 96  # samples of a block, about: longer ones cost more products, shorter ones more steps
MOST_KEPT = 16  # of a block's samples
FEWEST = 4  # columns: with fewer, sample by sample is as fast
LONGEST = 512  # a block of more is not worth its matrices


@dataclass(frozen=True)
class _Blocks:
    """Matrices of one block of L samples whose every `factor`-th is kept, the first one included.

    carry (s, s): both states over a block; taken (2 s + kept, L): what the samples give to the state of the run
    forward, to that of the run backward and to the kept outputs; turned (s, s): the backward state for the forward
    one; ahead, behind (kept, s): kept outputs for the forward and the backward state.
    """

    length: int
    carry: FloatArray
    taken: FloatArray
    turned: FloatArray
    ahead: FloatArray
    behind: FloatArray


def block_length(factor: int) -> int:
    """Samples of a block, a multiple of the factor; 0 where running block by block does not pay."""
    kept = min(max(-(-LENGTH // factor), 1), MOST_KEPT)
    return kept * factor if kept * factor <= LONGEST else 0


def kept_samples(sections: FloatArray, x: FloatArray, order: int, factor: int, first: int) -> FloatArray:
    """What `forward_backward` gives at every so many-th sample of x (N, ...), from a first one below `factor` on.

    Args:
        sections: shape (n_sections, 6).
        x: more than 3 * order samples, shape (N, ...).
        order: of the filter, which sets the length of the extension at the ends.
        factor: one sample in this many is kept.
        first: index of the first sample kept.

    Returns:
        Shape (ceil((N - first) / factor), ...).
    """
    extension = 3 * order
    # The run forward begins at rest on the very first sample: more of that one change nothing.
    front = -(extension + first) % factor
    way = odd_extension(x, extension, front).reshape(front + len(x) + 2 * extension, -1)
    count, start = -(-(len(x) - first) // factor), (front + extension + first) // factor
    kept = _forward_backward(sections, way, factor)[start : start + count]
    return kept.reshape(count, *x.shape[1:])


def _forward_backward(sections: FloatArray, x: FloatArray, factor: int) -> FloatArray:
    """Run forward and backward over x (N, K) from rest, keeping the first sample in every `factor`."""
    resting, columns = resting_states(sections.tobytes()), x.shape[1]
    length = block_length(factor)
    # Less than a whole block is left to run sample by sample, and at least one sample: it has the last output.
    count = (len(x) - 1) // length if length and columns >= FEWEST else 0
    whole = x[: count * length]
    state = resting.reshape(-1, 1) * x[0]
    if count:
        blocks = _blocks(sections.tobytes(), factor)
        size = len(blocks.carry)
        given = blocks.taken @ whole.reshape(count, length, columns)
        forward, state = _carried(blocks.carry, state, given[:, :size])
    end, _ = signal.sosfilt(sections, x[len(whole) :], axis=0, zi=state.reshape(*resting.shape, columns))
    initial = resting[:, :, None] * end[-1]
    end, initial = signal.sosfilt(sections, end[::-1], axis=0, zi=initial)
    end = end[::-1][::factor]
    if not count:
        return np.asarray(end, dtype=float)
    passed = given[:, size : 2 * size] + blocks.turned @ forward
    backward, _ = _carried(blocks.carry, initial.reshape(size, columns), passed[::-1])
    kept = given[:, 2 * size :] + blocks.ahead @ forward + blocks.behind @ backward[::-1]
    return np.concatenate((kept.reshape(-1, columns), end))


def _carried(carry: FloatArray, state: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
    """States (B, s, K) at which blocks begin, and the last one's end, from what each block adds (B, s, K)."""
    states = np.empty((len(given) + 1, *state.shape))
    states[0], states[1:] = state, given
    for k in range(len(given)):
        states[k + 1] += carry @ states[k]
    return states[:-1], states[-1]


@lru_cache(maxsize=64)
def _blocks(key: bytes, factor: int) -> _Blocks:
    sections = np.frombuffer(key).reshape(-1, 6).copy()
    length, size = block_length(factor), 2 * len(sections)
    # Every column a run of its own: a unit impulse at each sample, then a unit of each state.
    impulses = np.concatenate((np.eye(length), np.zeros((length, size))), axis=1)
    states = np.concatenate((np.zeros((size, length)), np.eye(size)), axis=1).reshape(-1, 2, length + size)
    outputs, after = signal.sosfilt(sections, impulses, axis=0, zi=states)
    after = after.reshape(size, -1)
    filtered, initial = outputs[:, :length], outputs[:, length:]
    fed, carry = after[:, :length], after[:, length:]
    back = fed[:, ::-1]
    kept = filtered[::-1, ::-1][::factor]
    return _Blocks(
        length=length,
        carry=np.ascontiguousarray(carry),
        taken=np.concatenate((fed, back @ filtered, kept @ filtered)),
        turned=back @ initial,
        ahead=kept @ initial,
        behind=np.ascontiguousarray(initial[::-1][::factor]),
    )
