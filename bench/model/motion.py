"""From the active joints to the motion of every joint: positions, velocities, accelerations (eqs. 2-4)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench.errors import BenchError
from bench.model.closure import Closures, closures_of, loop_bias, loop_rows
from bench.model.configuration import configuration_rates, hermite, integrate, normalised
from bench.model.elimination import Elimination, eliminate
from bench.model.follow import NEARLY_CLOSED, OPEN, Follower, Pose, advance, home_pose, make_follower
from bench.model.geometry import Geometry
from bench.model.kinematics import Frames, frames_of
from bench.model.scalars import Scalar, dot, minus, plus

CLOSED = (
    1e-10  # m or rad: after a smaller correction the loops are closed to rounding, and its Jacobian holds
)
NODE_CLOSED = 1e-6  # m or rad: the same at nodes, which are only interpolated
TRAVEL = 0.3  # active travel between followed nodes, rad, or in units of the robot's length for a slide
MIDDLE_TRAVEL = 0.1  # the same between the nodes of the middle level
STRIDE = 16  # samples between the nodes of the middle level
BLOCK = 5120  # most samples worked on together: more keep Python's share small, fewer stay in the cache
FEW = 0.4  # share of samples that a further correction is made for on their own
LARGEST_AMPLIFICATION = 200.0  # rad/rad, m/rad ...: passive speed for active speed; beyond it is singular
LARGEST_CORRECTION = 0.05  # m or rad: between an interpolated pose and the closed one
MOST_ITERATIONS = 6

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


def motion_of(
    geometry: Geometry,
    time: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    *,
    near: Motion | None = None,
) -> Motion:
    """Close all loops along a trajectory of the active joints, each (N, n), positions as logged.

    The closures are followed continuously from the home pose: a few nodes one after the other, then about
    every STRIDE-th sample from their interpolation, then all samples from theirs. Loops are closed to rounding;
    the Jacobian is taken at most CLOSED away from the closed pose, and rates have its relative error. near: the
    motion of nearly this trajectory or geometry at the same samples, from which the closures are tried at once.
    Raises BenchError that names the time of a sample which is out of reach or singular.
    """
    closures = closures_of(geometry)
    track = _Track(time, position - geometry.active_offset, velocity, acceleration)
    if not geometry.loops:
        return _solved(geometry, closures, track, lambda block: np.zeros((geometry.nq, len(time[block]))))
    if near is not None:
        try:
            return _solved(geometry, closures, track, _beside(geometry, near, track))
        except BenchError:
            pass  # too far: all the way from home
    travel = _travel(geometry, track.position)
    nodes = _nodes(travel, TRAVEL, len(time))
    followed = _followed(geometry, track, nodes).T
    coarse = _solved(geometry, closures, track.at(nodes), lambda block: followed[:, block], NODE_CLOSED)
    finer = track.at(_nodes(travel, MIDDLE_TRAVEL, STRIDE))
    middle = _solved(geometry, closures, finer, _between(geometry, coarse, finer), NODE_CLOSED)
    return _solved(geometry, closures, track, _between(geometry, middle, track))


def rates_at(
    geometry: Geometry, time: np.ndarray, q: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
) -> Motion:
    """The motion at closed poses q (N, nq), from active velocities and accelerations, each (N, n)."""
    track = _Track(time, q[:, geometry.active_configuration], velocity, acceleration)
    return _solved(geometry, closures_of(geometry), track, lambda block: q[block].T)


@dataclass(frozen=True)
class _Track:
    """What is given: time (N,); of the active joints position, velocity and acceleration, (N, n) each."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    def at(self, samples: np.ndarray) -> "_Track":
        return _Track(
            self.time[samples], self.position[samples], self.velocity[samples], self.acceleration[samples]
        )


def _solved(
    geometry: Geometry, closures: Closures, track: _Track, guess: _Guess, enough: float = CLOSED
) -> Motion:
    """Poses closed from the guess, velocities and accelerations, block by block."""
    samples, n = track.position.shape
    q = np.empty((samples, geometry.nq))
    v, a = np.empty((2, samples, geometry.nv))
    jacobian = np.zeros((samples, geometry.nv, n))
    jacobian[:, geometry.active, np.arange(n)] = 1.0
    left: list[np.ndarray] = []
    for block in blocks_of(samples, BLOCK):
        time = track.time[block]
        pose = np.ascontiguousarray(guess(block))
        pose[geometry.active_configuration] = track.position[block].T
        pose, frames, elimination, motors, still_open = _closed(
            geometry, closures, time, normalised(geometry, pose), enough
        )
        left.append(block.start + still_open)
        amplification = [elimination.solve(right) for right in motors]
        _check(geometry, time, amplification)
        speeds = _tree_rates(closures, amplification, track.velocity[block])
        bias = elimination.solve([minus(0.0, value) for value in loop_bias(closures, frames, speeds)])
        q[block] = pose.T
        for index, speed in enumerate(speeds):
            v[block, index] = speed
        for index, rate in enumerate(_tree_rates(closures, amplification, track.acceleration[block])):
            a[block, index] = plus(rate, bias[index]) if index in bias else rate
        for j, column in enumerate(amplification):
            for index, value in column.items():
                jacobian[block, index, j] = value
    few = np.concatenate(left) if left else np.arange(0)
    if len(few):
        nearly = np.ascontiguousarray(q[few].T)
        again = _solved(geometry, closures, track.at(few), lambda block: nearly[:, block], enough)
        q[few], v[few], a[few], jacobian[few] = again.q, again.v, again.a, again.jacobian
    return Motion(track.time, q, v, a, jacobian)


def blocks_of(samples: int, most: int) -> list[slice]:
    """The samples in as few blocks of nearly the same length as can be, each of at most so many."""
    count = -(-samples // most)
    return [slice(samples * k // count, samples * (k + 1) // count) for k in range(count)]


def _tree_rates(
    closures: Closures, amplification: list[dict[int, Scalar]], active: np.ndarray
) -> list[Scalar]:
    """All joints' rates (nv of them) for those of the active joints (K, n)."""
    motors = [np.ascontiguousarray(column) for column in active.T]
    rates: list[Scalar] = [0.0] * closures.nv
    for index, motor in zip(closures.active, motors, strict=True):
        rates[index] = motor
    for index in closures.passive:
        rates[index] = dot([column[index] for column in amplification], motors)
    return rates


def _closed(
    geometry: Geometry, closures: Closures, time: np.ndarray, q: np.ndarray, enough: float
) -> tuple[np.ndarray, Frames, Elimination, list[list[Scalar]], np.ndarray]:
    """Newton on all samples together, from poses q (nq, K) that are nearly closed.

    Returns the closed poses and what the last correction, smaller than `enough`, was found with: frames,
    reduced equations, and their right sides for every motor. Last come the few samples whose last correction was
    larger, though not by much: they need another.
    """
    moved = np.zeros(q.shape[1])
    step = np.zeros((geometry.nv, q.shape[1]))
    passive = set(closures.passive)
    for _ in range(MOST_ITERATIONS):
        frames = frames_of(closures.links, q)
        residual, rows = loop_rows(closures, frames)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            elimination = eliminate([{c: x for c, x in row.items() if c in passive} for row in rows])
            correction = elimination.solve([minus(0.0, value) for value in residual])
        for index, value in correction.items():
            step[index] = value
        size = np.abs(step).max(axis=0)
        moved += size
        if not moved.max() < LARGEST_CORRECTION:
            raise _singular(geometry, time, int(np.argmax(moved)))
        q = integrate(geometry, q, step)
        largest = float(size.max())
        nearly = largest < enough or (largest < NODE_CLOSED and (size >= enough).mean() < FEW)
        gap = max(np.abs(value).max() for value in (0.0, *residual))
        if nearly and gap < OPEN * max(enough, largest):
            still_open = np.flatnonzero(size >= enough)
            motors = [[minus(0.0, row.get(index, 0.0)) for row in rows] for index in closures.active]
            return q, frames, elimination, motors, still_open
    raise _singular(geometry, time, int(np.argmax(size)))


def _check(geometry: Geometry, time: np.ndarray, amplification: list[dict[int, Scalar]]) -> None:
    largest = np.zeros(len(time))
    for column in amplification:
        for value in column.values():
            np.maximum(largest, np.abs(value), out=largest)
    if not largest.max() < LARGEST_AMPLIFICATION:
        raise _singular(geometry, time, int(np.argmax(largest)))


def _between(geometry: Geometry, nodes: Motion, track: _Track) -> _Guess:
    """Poses between nodes: their interpolation, moved by what it is off at the active joints."""
    if len(nodes.time) == 1:
        return lambda block: np.repeat(nodes.q.T, len(track.time[block]), axis=1)
    first, second = configuration_rates(geometry, nodes.q.T, nodes.v.T, nodes.a.T)
    curve = hermite(nodes.time, nodes.q.T, first, second)
    middles = 0.5 * (nodes.time[1:] + nodes.time[:-1])

    def guess(block: slice) -> np.ndarray:
        time = track.time[block]
        q = normalised(geometry, np.ascontiguousarray(curve(time).T))
        off = track.position[block] - q[geometry.active_configuration].T
        nearest = nodes.jacobian[np.searchsorted(middles, time)]
        return integrate(geometry, q, np.einsum("kvj,kj->vk", nearest, off))

    return guess


def _beside(geometry: Geometry, near: Motion, track: _Track) -> _Guess:
    """Poses of another motion at the same samples, moved by what they are off at the active joints."""

    def guess(block: slice) -> np.ndarray:
        q = np.ascontiguousarray(near.q[block].T)
        off = track.position[block] - q[geometry.active_configuration].T
        if not off.any():
            return q
        return integrate(geometry, q, np.einsum("kvj,kj->vk", near.jacobian[block], off))

    return guess


def robot_length(geometry: Geometry) -> float:
    """The largest distance within a link [m]: what a slide's travel is compared with."""
    places = [joint.placement for joint in geometry.joints]
    places += [anchor.placement for loop in geometry.loops for anchor in (loop.first, loop.second)]
    return max([float(np.linalg.norm(place.translation)) for place in places] + [0.1])


def _travel(geometry: Geometry, active: np.ndarray) -> np.ndarray:
    """How far the active joints (N, n) have travelled at every sample, all together: (N,) rad or robot lengths."""
    slides = {joint.v.start for joint in geometry.joints if joint.kind == "slide"}
    scale = [1.0 / robot_length(geometry) if int(i) in slides else 1.0 for i in geometry.active]
    steps = np.abs(np.diff(np.ascontiguousarray(active.T), axis=1))
    return np.append(0.0, np.cumsum(np.array(scale) @ steps))


def _nodes(travel: np.ndarray, furthest: float, stride: int) -> np.ndarray:
    """Samples, first and last included, at most `stride` apart, the travel between them at most `furthest` where
    sampling is that fine.
    """
    count = int(np.ceil(travel[-1] / furthest)) + 1
    last = len(travel) - 1
    chosen = np.minimum(np.searchsorted(travel, np.linspace(0.0, travel[-1], count)), last)
    return np.unique(np.concatenate((np.arange(0, last, stride), chosen, [last])))


def _followed(geometry: Geometry, track: _Track, nodes: np.ndarray) -> np.ndarray:
    """Nearly closed poses (M, nq) at the nodes (sample indices), each reached from the one before."""
    follower = make_follower(geometry)
    pose = home_pose(follower)
    poses = np.empty((len(nodes), geometry.nq))
    before = -1
    for i, node in enumerate(nodes):
        reached, share = advance(follower, pose, track.position[node], NEARLY_CLOSED)
        if share < 1.0:
            reached = _followed_closely(follower, pose, track, range(before + 1, node + 1))
        poses[i], pose, before = reached.q, reached, node
    return poses


def _followed_closely(follower: Follower, pose: Pose, track: _Track, samples: range) -> Pose:
    """The pose at the last of the samples, along all of them: where the straight way to it is barred."""
    for sample in samples:
        pose, share = advance(follower, pose, track.position[sample])
        if share < 1.0:
            reached = pose.q[follower.geometry.active_configuration]
            raise _unreachable(follower.geometry, track.time[sample], track.position[sample], reached)
    return pose


def _unreachable(geometry: Geometry, time: float, wanted: np.ndarray, reached: np.ndarray) -> BenchError:
    offset, names = geometry.active_offset, geometry.robot.joints
    at = ", ".join(f"{name} = {value:.4g}" for name, value in zip(names, wanted + offset, strict=True))
    near = ", ".join(f"{value:.4g}" for value in reached + offset)
    return BenchError(
        f"t = {time:.4f} s: the loops of {geometry.robot.name} cannot be closed at {at} "
        f"(singular or out of reach; last closed at {near})"
    )


def _singular(geometry: Geometry, time: np.ndarray, sample: int) -> BenchError:
    return BenchError(
        f"t = {time[sample]:.4f} s: {geometry.robot.name} is at or near a singular pose; its loop closures "
        "do not determine the passive joints there"
    )
