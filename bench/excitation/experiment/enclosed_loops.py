"""Closed loops in whole intervals of time: where every joint is, how fast, and how the closures hold it.

About the pose in an interval's middle a set of poses is taken. In it, the closures' Jacobian by the passive joints A_p
is known up to a radius; with C, its inverse in the middle, so is I - C A_p, and with that J = -A_p^-1 A_a and the
speeds J v_a. A motion that cannot leave the set at these speeds within the interval stays in it. Where ||I - C A_p|| is
below 1 in a weighted maximum norm, no other pose of the set closes the loops with the motors there, so that the motion
cannot be in another assembly mode (Neumaier, "Interval Methods for Systems of Equations", 1990, chapter 5). Where
closures repeat one another, more of them than passive joints, it is their combination by C that counts.
"""

from dataclasses import dataclass, fields

import numpy as np

from bench.excitation.bounds import PROOF
from bench.excitation.experiment.motor_balls import Intervals, MotorBalls
from bench.model.balls import balls, dense_balls
from bench.model.closure import Closures, closures_of, loop_bias, loop_jacobian, loop_rows
from bench.model.configuration import displacements
from bench.model.geometry import Geometry
from bench.model.kinematics import frames_of
from bench.model.mobility import column_scales
from bench.model.motion import Motion, blocks_of, motion_of
from bench.model.scalars import Scalar
from bench.model.spin import idle_spins


@dataclass(frozen=True)
class Enclosure:
    """Intervals' poses q (K, nq) with radii; speeds, accelerations (K, nv) and the Jacobian (K, nv, n) of all joints by
    motors, about those of `motion`. rows, hold (K, m, nv): the closures' Jacobian in the middle and its radius. reach
    (K, nv): of the set of poses in which no other closes the loops, passed (K, nv): of that which the motion passes
    through. held (K,): whether all that is so; the rest counts only there. turned (K,): the norm of I - C A_p in reach.
    """

    motion: Motion
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    jacobian: np.ndarray
    rows: np.ndarray
    hold: np.ndarray
    reach: np.ndarray
    passed: np.ndarray
    held: np.ndarray
    turned: np.ndarray

    def at(self, chosen: np.ndarray) -> "Enclosure":
        """Some of the intervals."""
        arrays = {
            field.name: getattr(self, field.name)[chosen] for field in fields(self) if field.name != "motion"
        }
        return Enclosure(motion=self.motion.at(chosen), **arrays)


@dataclass(frozen=True)
class _Linear:
    """A_a, A_p and what they stray, (K, m, nv); how a solution of A_p x = y follows from C y."""

    closures: Closures
    inverse: np.ndarray
    radius: np.ndarray
    turned: np.ndarray
    weights: np.ndarray
    largest: np.ndarray

    def bounded(self, sizes: np.ndarray) -> np.ndarray:
        """Bounds (K, passive, c) of x with |x| <= sizes + |I - C A_p| |x|."""
        ratio = (sizes / self.weights[:, :, None]).max(axis=1, initial=0.0) / (1.0 - self.largest[:, None])
        return np.asarray(sizes + self.turned[:, :, None] * ratio[:, None, :])

    def jacobian(self, motion: Motion, middle: np.ndarray) -> np.ndarray:
        """How far J strays from the motion's, (K, passive, n)."""
        active, passive = list(self.closures.active), list(self.closures.passive)
        sizes = np.empty((len(middle), len(passive), len(active)))
        for part in _cached(middle):
            jacobian, radius = motion.jacobian[part][:, passive], self.radius[part]
            off = middle[part][:, :, active] + middle[part][:, :, passive] @ jacobian
            strays = radius[:, :, active] + radius[:, :, passive] @ np.abs(jacobian)
            sizes[part] = np.abs(self.inverse[part] @ off) + np.abs(self.inverse[part]) @ strays
        return self.bounded(sizes)


def enclosed(
    geometry: Geometry, intervals: Intervals, motors: MotorBalls, motion: Motion, *, rates: bool
) -> Enclosure:
    """The whole robot in every interval; motion: in their middles. rates: accelerations, too."""
    closures = closures_of(geometry)
    passive, active = geometry.passive, geometry.active
    half = intervals.half[:, None]
    (_, speed, growth), (_, speeding, growing) = motors.middle, motors.radius
    start = _start(geometry, closures, motion)
    passive_jacobian, fastest = np.abs(motion.jacobian[:, passive]), np.abs(speed) + speeding
    first = np.abs(motion.v[:, passive]) + _by(passive_jacobian, speeding)

    def moved(speeds: np.ndarray) -> np.ndarray:
        """Movement (K, nv) of all joints, with such speeds of the passive ones."""
        rates = np.zeros_like(motion.v)
        rates[:, active] = motors.radius[0]
        rates[:, passive] = half * speeds
        return _evened(geometry, rates)

    reach = moved(PROOF.wider * first)
    least = (
        PROOF.least_radius
        * (reach / column_scales(geometry)).max(axis=1, keepdims=True)
        * column_scales(geometry)
    )
    reach[:, passive] = np.maximum(reach, least)[:, passive] + 2.0 * start.bounds
    wide, middle = _linear(geometry, closures, motion, reach, reach, start.inverse)
    passed = moved(first + _by(wide.jacobian(motion, middle), fastest))
    passed[:, passive] += start.bounds
    held = (wide.largest <= PROOF.turned) & np.all(passed[:, passive] <= reach[:, passive], axis=1)
    for part in _vectors(geometry):
        held &= reach[:, part.start] <= PROOF.moved * column_scales(geometry)[part.start]
    passed = np.where(held[:, None], passed, reach)
    tight, middle = _linear(geometry, closures, motion, passed, reach, start.inverse)
    held &= tight.largest <= PROOF.turned
    jacobian = np.zeros_like(motion.jacobian)
    jacobian[:, passive] = tight.jacobian(motion, middle)
    again = moved(first + _by(jacobian[:, passive], fastest))
    again[:, passive] += start.bounds
    passed = np.minimum(passed, again)
    v = _by(np.abs(motion.jacobian), speeding) + _by(jacobian, fastest)
    a = np.zeros_like(v)
    if rates:
        a = _by(np.abs(motion.jacobian), growing) + _by(jacobian, np.abs(growth) + growing)
        a[:, passive] += _bias(geometry, motion, tight, middle, passed, v)
    return Enclosure(
        motion,
        _configurations(geometry, passed),
        v,
        a,
        jacobian,
        middle,
        tight.radius,
        reach,
        passed,
        held,
        wide.largest,
    )


def follows(geometry: Geometry, q: np.ndarray, passed: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Whether the motion of each interval but the last goes on as that of the next (K - 1,): then one of the two sets
    holds what both say of the time between them. q (K, nq): poses in the middles; the others as in `Enclosure`.

    Poses that differ by idle spins of rods are one: closures say nothing of these.
    """
    passive = geometry.passive

    def overlap(between: np.ndarray, first: np.ndarray) -> np.ndarray:
        into_first = np.all(between + passed[first + 1][:, passive] <= reach[first][:, passive], axis=1)
        into_second = np.all(between + passed[first][:, passive] <= reach[first + 1][:, passive], axis=1)
        return np.asarray(into_first | into_second)

    certain = overlap(_apart(geometry, q[:-1], q[1:])[:, passive], np.arange(len(q) - 1))
    uncertain = np.flatnonzero(~certain)
    if len(uncertain) and idle_spins(geometry):
        certain[uncertain] = overlap(
            _apart_but_for_spins(geometry, q[uncertain], q[uncertain + 1]), uncertain
        )
    return certain


def _apart_but_for_spins(geometry: Geometry, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Displacements (K, passive), evened, from configurations (K, nq) to others, without the rods' idle spins.

    What spins move is taken away to first order; its square is added.
    """
    spins, passive = len(idle_spins(geometry)), geometry.passive
    rows = loop_jacobian(geometry, first.T, passive)[:-spins].transpose(2, 0, 1)
    free = np.linalg.svd(rows)[2][:, -spins:]
    away = displacements(geometry, first.T, second.T)[passive].T
    spun = np.einsum("ksp,ks->kp", free, np.einsum("ksp,kp->ks", free, away))
    distances = np.zeros((len(first), geometry.nv))
    distances[:, passive] = np.abs(away - spun) + np.abs(spun).max(axis=1, keepdims=True) ** 2
    return np.asarray(_evened(geometry, distances)[:, passive])


def begins_at_home(geometry: Geometry, q: np.ndarray, reach: np.ndarray) -> bool:
    """Whether the first interval's set of poses holds home, its loops closed to rounding: a file rounds it."""
    motors = geometry.home[None, geometry.active_configuration] + geometry.active_offset
    still = np.zeros_like(motors)
    home = motion_of(geometry, np.zeros(1), motors, still, still).q
    off = _apart(geometry, home, q[:1])[:, geometry.passive]
    return bool(np.all(off <= reach[:1, geometry.passive]))


@dataclass(frozen=True)
class _Start:
    """C (K, passive, m), and how far the closed poses are at most from those of the motion (K, passive)."""

    inverse: np.ndarray
    bounds: np.ndarray


def _start(geometry: Geometry, closures: Closures, motion: Motion) -> _Start:
    samples, passive = len(motion.time), geometry.passive
    residual, middle, _ = _rows(closures, [row if row.any() else 0.0 for row in motion.q.T], samples)
    matrix = middle[:, :, passive]
    turned = matrix.transpose(0, 2, 1)
    with np.errstate(all="ignore"):
        inverse = (
            np.linalg.inv(matrix)
            if matrix.shape[1] == matrix.shape[2]
            else np.linalg.inv(turned @ matrix) @ turned
        )
    scales = column_scales(geometry)[passive]
    off = np.abs(np.einsum("kpm,km->kp", inverse, residual)) / scales
    bounds = np.zeros_like(motion.v)
    bounds[:, passive] = (
        2.0 / PROOF.least_radius * off.max(axis=1, keepdims=True, initial=0.0) + PROOF.closed
    ) * scales
    return _Start(inverse, _evened(geometry, bounds)[:, passive])


def _rows(closures: Closures, q: list[Scalar], samples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Residual (K, m), and the closures' Jacobian with its radius, (K, m, nv) each."""
    open_loops, rows = loop_rows(closures, frames_of(closures.links, q))
    residual = dense_balls(open_loops, samples)[0].T
    middle, radius = np.zeros((2, samples, len(rows), closures.nv))
    for i, row in enumerate(rows):
        columns = list(row)
        values, sizes = dense_balls([row[column] for column in columns], samples)
        middle[:, i, columns], radius[:, i, columns] = values.T, sizes.T
    return residual, middle, radius


def _linear(
    geometry: Geometry,
    closures: Closures,
    motion: Motion,
    reach: np.ndarray,
    weights: np.ndarray,
    inverse: np.ndarray,
) -> tuple[_Linear, np.ndarray]:
    """The closures' Jacobian in a set of poses, and in its middle; weights (K, nv): of the norm."""
    q = balls(motion.q.T, _configurations(geometry, reach).T)
    _, middle, radius = _rows(closures, q, len(motion.time))
    passive = geometry.passive
    weights = weights[:, passive]
    turned = np.empty_like(weights)
    for part in _cached(middle):
        off = np.abs(np.eye(len(passive)) - inverse[part] @ middle[part][:, :, passive])
        strays = _by(radius[part][:, :, passive], weights[part])
        turned[part] = _by(off, weights[part]) + _by(np.abs(inverse[part]), strays)
    largest = (turned / weights).max(axis=1, initial=0.0)
    return _Linear(closures, inverse, radius, turned, weights, largest), middle


def _bias(
    geometry: Geometry,
    motion: Motion,
    linear: _Linear,
    middle: np.ndarray,
    passed: np.ndarray,
    v: np.ndarray,
) -> np.ndarray:
    """How far what remains of the passive accelerations strays, motors not accelerated, (K, passive)."""
    closures, passive = linear.closures, geometry.passive
    frames = frames_of(closures.links, balls(motion.q.T, _configurations(geometry, passed).T))
    values, sizes = dense_balls(loop_bias(closures, frames, balls(motion.v.T, v.T)), len(motion.time))
    rest = motion.a[:, passive] - _by(motion.jacobian[:, passive], motion.a[:, geometry.active])
    off = np.abs(_by(linear.inverse, values.T + _by(middle[:, :, passive], rest)))
    sizes = sizes.T + _by(linear.radius[:, :, passive], np.abs(rest))
    return linear.bounded((off + _by(np.abs(linear.inverse), sizes))[:, :, None])[:, :, 0]


def _cached(matrices: np.ndarray) -> list[slice]:
    """Parts of matrices (K, r, c) that the processor's cache holds with what is computed of them."""
    return (
        blocks_of(len(matrices), max(PROOF.cached // max(matrices[0].nbytes, 1), 1)) if len(matrices) else []
    )


def _by(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Matrices (K, r, c) times vectors (K, c)."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])


def _evened(geometry: Geometry, sizes: np.ndarray) -> np.ndarray:
    """Tree displacements (K, nv) whose ball and free joints have one size for all directions: that of the vector."""
    even = sizes.copy()
    for part in _vectors(geometry):
        even[:, part] = np.linalg.norm(sizes[:, part], axis=1, keepdims=True)
    return even


def _vectors(geometry: Geometry) -> list[slice]:
    """The tree velocities that are vectors: of ball and free joints."""
    slices = []
    for joint in geometry.joints:
        if joint.kind in ("ball", "free"):
            slices += [slice(at, at + 3) for at in range(joint.v.start, joint.v.stop, 3)]
    return slices


def _configurations(geometry: Geometry, sizes: np.ndarray) -> np.ndarray:
    """Radii (K, nq) of configurations within displacements (K, nv) that are evened; a unit quaternion turned by an
    angle is off by at most half of it.
    """
    configuration = np.zeros((len(sizes), geometry.nq))
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            configuration[:, joint.q] = sizes[:, joint.v]
            continue
        if joint.kind == "free":
            configuration[:, joint.q.start : joint.q.start + 3] = sizes[:, joint.v.start : joint.v.start + 3]
        configuration[:, joint.q.stop - 4 : joint.q.stop] = 0.5 * sizes[:, joint.v.stop - 1 : joint.v.stop]
    return configuration


def _apart(geometry: Geometry, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Displacements (K, nv), evened, from configurations (K, nq) to others."""
    distances = np.zeros((len(second), geometry.nv))
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            distances[:, joint.v] = np.abs(second[:, joint.q] - first[:, joint.q])
            continue
        if joint.kind == "free":
            at = slice(joint.q.start, joint.q.start + 3)
            away = np.linalg.norm(second[:, at] - first[:, at], axis=1)
            distances[:, joint.v.start : joint.v.start + 3] = away[:, None]
        at = slice(joint.q.stop - 4, joint.q.stop)
        along = np.abs((second[:, at] * first[:, at]).sum(axis=1))
        across = np.minimum(
            np.linalg.norm(second[:, at] - first[:, at], axis=1),
            np.linalg.norm(second[:, at] + first[:, at], axis=1),
        )
        angle = 4.0 * np.arctan2(across, np.sqrt(2.0 * (1.0 + along)))
        distances[:, joint.v.stop - 3 : joint.v.stop] = angle[:, None]
    return distances
