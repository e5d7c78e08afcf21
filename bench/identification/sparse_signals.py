"""A recording at the few samples that the fit's band needs, for columns used only in a search."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.effects import JointSignals
from bench.identification.standstill import Gaps


@dataclass(frozen=True)
class SparseJoint(JointSignals):
    """A joint at one of `every` samples; torques are smoothed before, at all samples. whole: the joint there."""

    whole: JointSignals
    every: int

    @cached_property
    def needed_torque(self) -> np.ndarray:
        """See `JointSignals`."""
        return self.whole.needed_torque[:: self.every]

    @cached_property
    def motor_torque(self) -> np.ndarray:
        """See `JointSignals`."""
        return self.whole.motor_torque[:: self.every]

    def follows(self, phase: np.ndarray) -> np.ndarray:
        """See `JointSignals`: the few samples are less than half a period apart."""
        return np.asarray(np.abs(np.gradient(phase)) < np.pi)


def sparse_joint(whole: JointSignals, every: int) -> SparseJoint:
    """The joint at one of `every` samples."""
    some = slice(None, None, every)
    return SparseJoint(
        time=whole.time[some],
        position=whole.position[some],
        velocity=whole.velocity[some],
        acceleration=whole.acceleration[some],
        current=whole.current[some],
        gain=whole.gain,
        speed=whole.speed,
        rate=whole.rate / every,
        band=whole.band,
        rotates=whole.rotates,
        needs=whole.needs,
        whole=whole,
        every=every,
    )


def sparse_gaps(gaps: Gaps, every: int, length: int) -> tuple[Gaps, tuple[np.ndarray, ...]]:
    """Stretches of few samples in which joints are at rest, including the edges; shares (K,) for every joint: the part
    of each sample's interval, half of the way to its neighbours, that lies in a stretch.
    """
    sparse, shares = [], []
    count = -(-length // every)
    edges = np.clip(np.arange(count + 1) * every - every // 2, 0, length)
    for stretches in gaps:
        inside = np.zeros(length + 1)
        for start, stop, _ in stretches:
            inside[start + 1 : stop + 1] = 1.0
        before = np.cumsum(inside)[edges]
        shares.append(np.diff(before) / np.diff(edges))
        few = np.empty_like(stretches)
        few[:, 0] = (stretches[:, 0] + every // 2) // every
        few[:, 1] = np.minimum((stretches[:, 1] - 1 + every // 2) // every + 1, count)
        few[:, 2] = np.maximum(np.round(stretches[:, 2] / every), 1)
        sparse.append(few)
    return tuple(sparse), tuple(shares)
