"""From the active joints to the motion of every joint: positions, velocities, accelerations (eqs. 2-4)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.interpolation import FEWEST, cubic_spline
from bench.model.bounds import CLOSURE, NODES
from bench.model.closing import Closing
from bench.model.closure import Closures, closures_of
from bench.model.configuration import configuration_rates, hermite, integrate, normalised
from bench.model.geometry import Geometry
from bench.model.nodes import NearSingularError, Samples, Track, followed, nodes_along, travel_of
from bench.model.scalars import Scalar

_Guess = Callable[[slice], np.ndarray]  # nearly closed poses (nq, K) of a slice of the samples


@dataclass(frozen=True)
class Motion:
    """The motion of the whole robot, in Pinocchio's coordinates.

    time (N,) s; q (N, nq); v and a (N, nv), rad, m and their rates; jacobian (N, nv, n): the tree velocities
    for the active velocities, J_t and J_p of equations 3 and 6.
    """

    time: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    jacobian: np.ndarray

    def at(self, samples: Samples) -> "Motion":
        """The motion at some of the samples, K of them."""
        return Motion(
            self.time[samples], self.q[samples], self.v[samples], self.a[samples], self.jacobian[samples]
        )


class LongMotion(Motion):
    """A motion too long to be kept: it is stored at few samples, and computed on demand.

    On demand for all samples it is computed and kept until `forget`. whole: the motion, if known already.
    """

    def __init__(self, path: "Path", whole: Motion | None = None) -> None:
        self.__dict__.update(time=path.track.time, path=path)
        if whole is not None:
            self.__dict__["_whole"] = whole

    def forget(self) -> None:
        """Keep only what is needed to compute the very same motion again."""
        self.__dict__.pop("_whole", None)

    def at(self, samples: Samples) -> Motion:
        """The motion at some of the samples, K of them."""
        if "_whole" in self.__dict__:
            return self._whole.at(samples)
        path: Path = self.__dict__["path"]
        return path.motion(samples)

    @cached_property
    def _whole(self) -> Motion:
        path: Path = self.__dict__["path"]
        return path.motion(slice(None))

    @property
    def q(self) -> np.ndarray:
        """See `Motion`."""
        return self._whole.q

    @property
    def v(self) -> np.ndarray:
        """See `Motion`."""
        return self._whole.v

    @property
    def a(self) -> np.ndarray:
        """See `Motion`."""
        return self._whole.a

    @property
    def jacobian(self) -> np.ndarray:
        """See `Motion`."""
        return self._whole.jacobian


def motion_of(
    geometry: Geometry,
    time: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    *,
    near: Motion | None = None,
    most: float = np.inf,
) -> Motion:
    """Close all loops along a trajectory of the active joints, each (N, n), positions as logged.

    The closures are followed continuously from the home pose: a few nodes one after the other, then about every
    `NODES.stride`-th sample from their interpolation (or one after the other, if it is too far off), then all samples
    from theirs. Loops are closed to rounding; the Jacobian is computed at most `CLOSURE.closed_rates` away from the
    closed pose, and rates have its relative error. near: the motion of nearly this trajectory or geometry at the same
    samples, tried first as a start. most: bound for the entries of the loop Jacobian. Raises BenchError that names the
    time of a sample which is out of reach or singular.
    """
    if near is not None and geometry.closed:
        track = Track(time, position, velocity, acceleration, geometry.active_offset)
        try:
            return _solved(geometry, closures_of(geometry), track, _guess_near(geometry, near, track))
        except BenchError:
            pass  # too far: follow from home
    return path_of(geometry, time, position, velocity, acceleration, most).motion(slice(None))


def path_of(
    geometry: Geometry,
    time: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    most: float = np.inf,
) -> "Path":
    """The closures followed along a trajectory at few samples; see `motion_of`."""
    closures = closures_of(geometry)
    track = Track(time, position, velocity, acceleration, geometry.active_offset)
    if not geometry.closed:
        return Path(geometry, closures, track, lambda time, _: np.zeros((geometry.nq, len(time))))
    middle = _middle_level(geometry, closures, track, most)
    return Path(geometry, closures, track, _between(geometry, middle), middle)


def _middle_level(geometry: Geometry, closures: Closures, track: Track, most: float) -> Motion:
    """The motion at the nodes of the middle level, from few followed ones; if the motion between these is too curved
    for interpolation, all nodes are followed. If nodes would be most of the samples, every sample is one. Raises
    BenchError naming the time of one that cannot be closed.
    """
    travel = travel_of(geometry, track.logged)
    nodes = nodes_along(travel, NODES.travel, len(track.time))
    reached = followed(geometry, track, nodes, most).T
    coarse = _solved(geometry, closures, track.at(nodes), lambda block: reached[:, block], CLOSURE.closed)
    guess = _between(geometry, coarse)
    nodes, enough = nodes_along(travel, NODES.middle_travel, NODES.stride), CLOSURE.closed
    if 2 * len(nodes) > len(track.time):
        nodes, enough = np.arange(len(track.time)), CLOSURE.closed_rates
    finer = track.at(nodes)
    try:
        return _solved(
            geometry, closures, finer, lambda block: guess(finer.time[block], finer.position(block)), enough
        )
    except BenchError:  # too far apart, as when passive joints turn fast for a slide's travel; or singular
        reached = followed(geometry, track, nodes).T
        return _solved(geometry, closures, finer, lambda block: reached[:, block], enough)


@dataclass(frozen=True)
class Path:
    """A trajectory (N samples) with nearly closed poses, from which the motion at any samples follows.

    guess: nearly closed poses (nq, K) for the times (K,) and the positions (K, n) of the active joints. nodes: the
    motion at few samples, between which it interpolates; None without loops.
    """

    geometry: Geometry
    closures: Closures
    track: "Track"
    guess: Callable[[np.ndarray, np.ndarray], np.ndarray]
    nodes: Motion | None = None

    def rates(self, joints: Sequence[int]) -> np.ndarray:
        """Velocities (N, k) of some tree coordinates (indices) at all samples, without closing the loops there.

        Their Jacobian is interpolated between the nodes, which are close relative to its curvature.
        """
        time, velocity = self.track.time, self.track.velocity
        joint_rates = np.empty((len(time), len(joints)))
        if not len(joints):
            return joint_rates
        near = self.nodes if self.nodes is not None and len(self.nodes.time) >= FEWEST else None
        curve = None if near is None else cubic_spline(near.time, near.jacobian[:, joints])
        for block in blocks_of(len(time), NODES.block):
            if curve is None:
                joint_rates[block] = self.motion(block).v[:, joints]
            else:
                joint_rates[block] = np.einsum("kvj,kj->kv", curve(time[block]), velocity[block])
        return joint_rates

    def motion(self, samples: Samples) -> Motion:
        """The motion at these samples. Raises BenchError if the loops cannot be closed."""
        if self.nodes is not None and len(self.nodes.time) == len(self.track.time):
            return self.nodes.at(samples)
        track = self.track.at(samples)
        return _solved(
            self.geometry,
            self.closures,
            track,
            lambda block: self.guess(track.time[block], track.position(block)),
        )


def motion_near(
    geometry: Geometry, near: Motion, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
) -> Motion:
    """The motion at samples that need not be consecutive, from the similar motion `near`.

    Active positions, velocities and accelerations are (N, n) each. Raises BenchError if the loops cannot be closed from
    there.
    """
    track = Track(near.time, position, velocity, acceleration, geometry.active_offset)
    return _solved(geometry, closures_of(geometry), track, _guess_near(geometry, near, track))


def rates_at(
    geometry: Geometry, time: np.ndarray, q: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
) -> Motion:
    """The motion at closed poses q (N, nq), from active velocities and accelerations, each (N, n)."""
    nothing = np.zeros(len(geometry.active))
    track = Track(time, q[:, geometry.active_configuration], velocity, acceleration, nothing)
    return _solved(geometry, closures_of(geometry), track, lambda block: q[block].T)


def at_speeds(
    geometry: Geometry, motion: Motion, velocities: Sequence[np.ndarray], acceleration: np.ndarray
) -> list[Motion]:
    """A motion with the same poses at other active velocities, (N, n) each, and active accelerations (N, n)."""
    closing = Closing(geometry)
    closing.correct(np.ascontiguousarray(motion.q.T))
    closing.amplify()
    motions = []
    for velocity in velocities:
        v, a = np.empty((2, *motion.v.shape))
        for index, (speed, growth) in enumerate(zip(*closing.rates(velocity, acceleration), strict=True)):
            v[:, index], a[:, index] = speed, growth
        motions.append(Motion(motion.time, motion.q, v, a, motion.jacobian))
    return motions


def _solved(
    geometry: Geometry, closures: Closures, track: Track, guess: _Guess, enough: float = CLOSURE.closed_rates
) -> Motion:
    """Poses closed from the guess, velocities and accelerations, block by block."""
    samples, n = track.logged.shape
    q = np.empty((samples, geometry.nq))
    v, a = np.empty((2, samples, geometry.nv))
    jacobian = np.zeros((samples, geometry.nv, n))
    jacobian[:, geometry.active, np.arange(n)] = 1.0
    motion = Motion(track.time, q, v, a, jacobian)
    unsolved = [
        block.start + _solve_block(geometry, closures, track, guess, enough, block, motion)
        for block in blocks_of(samples, NODES.block)
    ]
    few = np.concatenate(unsolved) if unsolved else np.arange(0)
    if len(few):
        nearly = np.ascontiguousarray(q[few].T)
        again = _solved(geometry, closures, track.at(few), lambda block: nearly[:, block], enough)
        q[few], v[few], a[few], jacobian[few] = again.q, again.v, again.a, again.jacobian
    return motion


def _solve_block(
    geometry: Geometry,
    closures: Closures,
    track: Track,
    guess: _Guess,
    enough: float,
    block: slice,
    motion: Motion,
) -> np.ndarray:
    """Write the motion at a block of samples; returns open ones (indices in the block), see `_closed`."""
    time = track.time[block]
    pose = np.ascontiguousarray(guess(block))
    pose[geometry.active_configuration] = track.position(block).T
    closing = Closing(geometry)
    pose, still_open = _closed(geometry, closing, closures, time, normalised(geometry, pose), enough)
    amplification = closing.amplify()
    _check(geometry, time, amplification)
    speeds, growths = closing.rates(track.velocity[block], track.acceleration[block])
    motion.q[block] = pose.T
    for index, (speed, growth) in enumerate(zip(speeds, growths, strict=True)):
        motion.v[block, index] = speed
        motion.a[block, index] = growth
    for j, column in enumerate(amplification):
        for index, value in column.items():
            motion.jacobian[block, index, j] = value
    return still_open


def joined(motions: Sequence[Motion]) -> Motion:
    """Motions concatenated."""
    return Motion(
        np.concatenate([motion.time for motion in motions]),
        np.concatenate([motion.q for motion in motions]),
        np.concatenate([motion.v for motion in motions]),
        np.concatenate([motion.a for motion in motions]),
        np.concatenate([motion.jacobian for motion in motions]),
    )


def blocks_of(samples: int, most: int) -> list[slice]:
    """The samples in as few blocks of nearly equal length as possible, each of at most `most`."""
    count = -(-samples // most)
    return [slice(samples * k // count, samples * (k + 1) // count) for k in range(count)]


def _closed(
    geometry: Geometry, closing: Closing, closures: Closures, time: np.ndarray, q: np.ndarray, enough: float
) -> tuple[np.ndarray, np.ndarray]:
    """Newton on all samples together, from poses q (nq, K) that are nearly closed.

    Returns the closed poses; `closing` is where the last correction, smaller than `enough`, was found. Last come
    the few samples whose last correction was larger, though not by much: they need another.
    """
    moved = np.zeros(q.shape[1])
    step = np.zeros((geometry.nv, q.shape[1]))
    slack = CLOSURE.slack if closures.equations > len(closures.passive) else 0.0
    for _ in range(CLOSURE.interpolated):
        residual, correction = closing.correct(q)
        for index, value in correction.items():
            step[index] = value
        size = np.abs(step).max(axis=0)
        moved += size
        if not moved.max() < CLOSURE.correction:
            raise _singular(geometry, time, int(np.argmax(moved)))
        q = integrate(geometry, q, step)
        largest = float(size.max())
        nearly = largest < enough or (largest < CLOSURE.closed and (size >= enough).mean() < NODES.few)
        gap = max(np.abs(value).max() for value in (0.0, *residual))
        if nearly and gap < max(CLOSURE.open * max(enough, largest), slack):
            return q, np.flatnonzero(size >= enough)
    raise _singular(geometry, time, int(np.argmax(size)))


def _check(geometry: Geometry, time: np.ndarray, amplification: list[dict[int, Scalar]]) -> None:
    largest = np.zeros(len(time))
    for column in amplification:
        for value in column.values():
            np.maximum(largest, np.abs(value), out=largest)
    if not largest.max() < CLOSURE.amplification:
        raise _singular(geometry, time, int(np.argmax(largest)))


def _between(geometry: Geometry, nodes: Motion) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Poses between nodes: their interpolation, corrected by its error at the active joints."""
    if len(nodes.time) == 1:
        return lambda time, _: np.repeat(nodes.q.T, len(time), axis=1)
    first, second = configuration_rates(geometry, nodes.q.T, nodes.v.T, nodes.a.T)
    curve = hermite(nodes.time, nodes.q.T, first, second)
    middles = 0.5 * (nodes.time[1:] + nodes.time[:-1])

    def guess(time: np.ndarray, position: np.ndarray) -> np.ndarray:
        q = normalised(geometry, np.ascontiguousarray(curve(time).T))
        off = position - q[geometry.active_configuration].T
        nearest = nodes.jacobian[np.searchsorted(middles, time)]
        return integrate(geometry, q, np.einsum("kvj,kj->vk", nearest, off))

    return guess


def _guess_near(geometry: Geometry, near: Motion, track: Track) -> _Guess:
    """Poses of another motion at the same samples, corrected by their error at the active joints."""

    def guess(block: slice) -> np.ndarray:
        q = np.ascontiguousarray(near.q[block].T)
        off = track.position(block) - q[geometry.active_configuration].T
        if not off.any():
            return q
        return integrate(geometry, q, np.einsum("kvj,kj->vk", near.jacobian[block], off))

    return guess


def _singular(geometry: Geometry, time: np.ndarray, sample: int) -> NearSingularError:
    return NearSingularError(
        f"t = {time[sample]:.4f} s: {geometry.robot.name} is at or near a singular pose; its loop closures "
        "do not determine the passive joints there"
    )
