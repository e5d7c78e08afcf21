"""Zero-phase filter and decimation in one: second-order sections, block by block.

A filter with state s takes a block of samples x to outputs T x + O s and to the state F x + P s. So does its run
backward over those outputs, and both together: all that is between x and the few samples that are kept are
constant matrices, which take many blocks at once. Only the states are carried from block to block. The numbers are
those of the run sample by sample, except for rounding.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.signals.bounds import BLOCKS
from bench.signals.filtering import extended_end, extended_start, resting_states
from bench.signals.sections import carried, filtered, one_by_one

FloatArray = NDArray[np.float64]


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
    kept = min(max(-(-BLOCKS.length // factor), 1), BLOCKS.kept)
    return kept * factor if kept * factor <= BLOCKS.longest else 0


class RunningFilter:
    """Forward and backward over samples that come in parts, keeping every so many-th; see `kept_samples`.

    Only what the run backward needs of each block stays: its states and kept outputs, not its samples.
    """

    def __init__(self, sections: FloatArray, order: int, factor: int, first: int) -> None:
        self._sections, self._factor, self._extension = sections, factor, 3 * order
        # The run forward begins at rest on the very first sample: more of that one change nothing.
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
        # The last samples are needed whole, to extend the end; those of a block that is not full wait.
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
        """Run forward over whole blocks of at most so many samples, and return how many these were."""
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
    """What `forward_backward` gives at every so many-th sample of x (N, ...), from a first one below `factor` on.

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
