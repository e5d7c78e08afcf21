"""Closed loops in whole intervals of time: bounds of poses, speeds and closure Jacobians.

Take a set of poses about the pose in an interval's middle. In it, the closures' Jacobian by the passive joints A_p is
known up to a radius; with C, its inverse in the middle, so is I - C A_p, and hence J = -A_p^-1 A_a and the speeds J
v_a. A motion that cannot leave the set at these speeds within the interval stays in it. If ||I - C A_p|| is below 1 in
a weighted maximum norm, no other pose of the set closes the loops at the same motor positions, so the motion cannot be
in another assembly mode (Neumaier, "Interval Methods for Systems of Equations", 1990, chapter 5). Redundant closures,
more than passive joints, count in their combination by C.
"""

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from bench.excitation.bounds import PROOF
from bench.excitation.experiment.between_samples import Intervals, MotorBalls
from bench.model.balls import balls, dense_balls
from bench.model.closure import Closures, closures_of, loop_bias, loop_jacobian, loop_rows
from bench.model.configuration import displacements, integrate
from bench.model.geometry import Geometry
from bench.model.kinematics import frames_of
from bench.model.mobility import column_scales
from bench.model.motion import Motion, blocks_of, motion_of
from bench.model.scalars import Scalar
from bench.model.spin import idle_spins


@dataclass(frozen=True)
class Enclosure:
    """Intervals whose loops are held: poses q (K, nq) with radii; speeds, accelerations (K, nv) and the Jacobian (K,
    nv, n) of all joints by motors, about those of `motion`. linear: of the closures. passed (K, nv): radii of the poses
    that the motion passes through; strays (K, nv): its distance, at the intervals' ends, from motion at the middle's
    speeds.
    """

    motion: Motion
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    jacobian: np.ndarray
    linear: "LinearClosures"
    passed: np.ndarray
    strays: np.ndarray


@dataclass(frozen=True)
class PoseSets:
    """Sets of poses about the middles of intervals in which no other closes the loops. reach (K, nv): radii; passed (K,
    nv): those of the poses that the motion passes; held (K,): whether this is proven; else the rest is invalid. excess
    (K,): factor by which an interval is too long, about. inverse (K, passive, m): C; bounds (K, passive): largest
    distance of closed poses from the motion's; rounding: see `LinearClosures`.
    """

    reach: np.ndarray
    passed: np.ndarray
    held: np.ndarray
    excess: np.ndarray
    inverse: np.ndarray
    bounds: np.ndarray
    rounding: np.ndarray

    def at(self, chosen: np.ndarray) -> "PoseSets":
        """Some of the intervals."""
        return PoseSets(*(getattr(self, field.name)[chosen] for field in fields(self)))


@dataclass(frozen=True)
class LinearClosures:
    """The closures' Jacobian [A_a, A_p] in the middle of a set of poses and its radius, (K, m, nv); inverse: C (K,
    passive, m), and how a solution of A_p x = y follows from C y. rounding (K, passive): of C, |I - C A_p| in the
    middle times the `column_scales`.
    """

    closures: Closures
    inverse: np.ndarray
    middle: np.ndarray
    radius: np.ndarray
    turned: np.ndarray
    weights: np.ndarray
    largest: np.ndarray
    rounding: np.ndarray

    def bounded(self, sizes: np.ndarray) -> np.ndarray:
        """Bounds (K, passive, c) of x with |x| <= sizes + |I - C A_p| |x|."""
        ratio = (sizes / self.weights[:, :, None]).max(axis=1, initial=0.0) / (1.0 - self.largest[:, None])
        return np.asarray(sizes + self.turned[:, :, None] * ratio[:, None, :])

    def jacobian(self, motion: Motion) -> np.ndarray:
        """Radius (K, passive, n) of J about the motion's."""
        active, passive = list(self.closures.active), list(self.closures.passive)
        sizes = np.empty((len(self.middle), len(passive), len(active)))
        for part in _cached(self.middle):
            jacobian, middle, radius = motion.jacobian[part][:, passive], self.middle[part], self.radius[part]
            off = middle[:, :, active] + middle[:, :, passive] @ jacobian
            strays = radius[:, :, active] + radius[:, :, passive] @ np.abs(jacobian)
            sizes[part] = np.abs(self.inverse[part] @ off) + np.abs(self.inverse[part]) @ strays
        return self.bounded(sizes)


def pose_sets(geometry: Geometry, intervals: Intervals, motors: MotorBalls, motion: Motion) -> PoseSets:
    """The sets of poses of every interval; motion: in their middles."""
    closures, passive = closures_of(geometry), geometry.passive
    scales = column_scales(geometry)
    inverse, bounds = _start(geometry, closures, motion)
    speeds = _Speeds(geometry, intervals, motors, motion)
    reach = speeds.moved(PROOF.wider * speeds.first)
    least = PROOF.least_radius * (reach / scales).max(axis=1, keepdims=True) * scales
    reach[:, passive] = np.maximum(reach, least)[:, passive] + 2.0 * bounds
    wide = _linear(geometry, closures, motion, reach, reach, inverse)
    straying = _by(wide.jacobian(motion), speeds.fastest)
    passed = speeds.moved(speeds.first + straying)
    passed[:, passive] += bounds
    held = (wide.largest <= PROOF.turned) & np.all(passed[:, passive] <= reach[:, passive], axis=1)
    for part in _vectors(geometry):
        held &= reach[:, part.start] <= PROOF.moved * scales[part.start]
    excess = wide.largest / PROOF.turned
    return PoseSets(
        reach, np.where(held[:, None], passed, reach), held, excess, inverse, bounds, wide.rounding
    )


@dataclass(frozen=True)
class _Speeds:
    """Speeds in intervals: first (K, passive), of the passive joints, by the Jacobian in the middles; fastest (K, n),
    of the motors.
    """

    geometry: Geometry
    intervals: Intervals
    motors: MotorBalls
    motion: Motion

    @cached_property
    def fastest(self) -> np.ndarray:
        """Speeds of the motors."""
        return np.asarray(np.abs(self.motors.middle[1]) + self.motors.radius[1])

    @cached_property
    def changes(self) -> np.ndarray:
        """Effect of the motors' speed changes on all joints (K, nv), by the Jacobian in the middles."""
        return _by(np.abs(self.motion.jacobian), self.motors.radius[1])

    @cached_property
    def first(self) -> np.ndarray:
        """Speeds of the passive joints."""
        return np.asarray((np.abs(self.motion.v) + self.changes)[:, self.geometry.passive])

    def moved(self, speeds: np.ndarray) -> np.ndarray:
        """Movement (K, nv) of all joints, at these speeds of passive ones."""
        rates = np.zeros_like(self.motion.v)
        rates[:, self.geometry.active] = self.motors.radius[0]
        rates[:, self.geometry.passive] = self.intervals.half[:, None] * speeds
        return _evened(self.geometry, rates)


def enclosed(
    geometry: Geometry,
    intervals: Intervals,
    motors: MotorBalls,
    motion: Motion,
    sets: PoseSets,
    *,
    rates: bool,
) -> Enclosure:
    """The whole robot in every interval, all of which are held; motion: in their middles. rates: accelerations, too."""
    closures, passive = closures_of(geometry), geometry.passive
    speeds = _Speeds(geometry, intervals, motors, motion)
    tight = _linear(geometry, closures, motion, sets.passed, sets.reach, sets.inverse, sets.rounding)
    jacobian = np.zeros_like(motion.jacobian)
    jacobian[:, passive] = tight.jacobian(motion)
    v = speeds.changes + _by(jacobian, speeds.fastest)
    passed = speeds.moved(speeds.first + _by(jacobian[:, passive], speeds.fastest))
    strays = speeds.moved(v[:, passive])
    passed[:, passive] += sets.bounds
    strays[:, passive] += sets.bounds
    passed = np.minimum(sets.passed, passed)
    for joint in geometry.joints:
        if joint.kind == "free":  # it shifts along axes that turn
            at = joint.v.start
            strays[:, at : at + 3] += passed[:, at : at + 1] * passed[:, at + 3 : at + 4]
    a = np.zeros_like(v)
    if rates:
        _, _, growing = motors.radius
        a = _by(np.abs(motion.jacobian), growing) + _by(jacobian, np.abs(motors.middle[2]) + growing)
        a[:, passive] += _bias(geometry, motion, tight, passed, v)
    return Enclosure(motion, _configurations(geometry, passed), v, a, jacobian, tight, passed, strays)


def follows(
    geometry: Geometry, intervals: Intervals, motion: Motion, strays: np.ndarray, reach: np.ndarray
) -> np.ndarray:
    """Whether the motion of each interval but the last continues in the next (K - 1,): then one's set of poses contains
    the other's motion at the time between them, and no other pose closes the loops there. motion: in the middles; the
    others as in `Enclosure` and `PoseSets`.

    Poses that differ only by idle spins of rods count as one: closures do not determine these.
    """
    passive, q = geometry.passive, motion.q
    way = intervals.half * motion.v.T
    ends, starts = integrate(geometry, q.T, way).T, integrate(geometry, q.T, -way).T
    certain = np.zeros(len(q) - 1, dtype=bool)
    for measure in (_apart, _apart_but_for_spins) if idle_spins(geometry) else (_apart,):
        first = np.flatnonzero(~certain)
        for place, of, into in ((ends, first, first + 1), (starts, first + 1, first)):
            off = measure(geometry, place[of], q[into])[:, passive] + strays[of][:, passive]
            certain[first] |= np.all(off <= reach[into][:, passive], axis=1)
    return certain


def _apart_but_for_spins(geometry: Geometry, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Displacements (K, nv), evened, from configurations (K, nq) to others, without the rods' idle spins.

    What spins move is taken away to first order; its square is added. It moves no loop, and the rows of the idle spins
    as all of the way does.
    """
    passive = geometry.passive
    rows = loop_jacobian(geometry, first.T, passive).transpose(2, 0, 1)
    away = displacements(geometry, first.T, second.T)[passive].T
    moved = _by(rows, away)
    moved[:, : -len(idle_spins(geometry))] = 0.0
    spun = _by(_inverse(rows), moved)
    distances = np.zeros((len(first), geometry.nv))
    distances[:, passive] = np.abs(away - spun) + np.abs(spun).max(axis=1, keepdims=True) ** 2
    return _evened(geometry, distances)


def begins_at_home(geometry: Geometry, q: np.ndarray, reach: np.ndarray) -> bool:
    """Whether the first interval's set of poses contains home, with loops closed to the file's rounding."""
    motors = geometry.home[None, geometry.active_configuration] + geometry.active_offset
    still = np.zeros_like(motors)
    home = motion_of(geometry, np.zeros(1), motors, still, still).q
    off = _apart(geometry, home, q[:1])[:, geometry.passive]
    return bool(np.all(off <= reach[:1, geometry.passive]))


def _start(geometry: Geometry, closures: Closures, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """C (K, passive, m), and the largest distance (K, passive) of closed poses from those of the motion."""
    samples, passive = len(motion.time), geometry.passive
    residual, middle, _ = _rows(closures, [row if row.any() else 0.0 for row in motion.q.T], samples)
    with np.errstate(all="ignore"):
        inverse = _inverse(middle[:, :, passive])
    scales = column_scales(geometry)[passive]
    off = np.abs(np.einsum("kpm,km->kp", inverse, residual)) / scales
    bounds = np.zeros_like(motion.v)
    bounds[:, passive] = (
        2.0 / PROOF.least_radius * off.max(axis=1, keepdims=True, initial=0.0) + PROOF.closed
    ) * scales
    return inverse, _evened(geometry, bounds)[:, passive]


def _inverse(matrices: np.ndarray) -> np.ndarray:
    """Pseudo-inverse of matrices (K, m, p), m >= p."""
    if matrices.shape[1] == matrices.shape[2]:
        return np.linalg.inv(matrices)
    turned = matrices.transpose(0, 2, 1)
    return np.asarray(np.linalg.inv(turned @ matrices) @ turned)


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
    rounding: np.ndarray | None = None,
) -> LinearClosures:
    """The closures in a set of poses; weights (K, nv): of the norm; rounding: of `LinearClosures`, computed if None."""
    q = balls(motion.q.T, _configurations(geometry, reach).T)
    _, middle, radius = _rows(closures, q, len(motion.time))
    passive = geometry.passive
    weights, scales = weights[:, passive], column_scales(geometry)[passive]
    if rounding is None:
        rounding = np.empty_like(weights)
        for part in _cached(middle):
            turns = np.eye(len(passive)) - inverse[part] @ middle[part][:, :, passive]
            rounding[part] = np.abs(turns) @ scales
    turned = rounding * (weights / scales).max(axis=1, keepdims=True, initial=0.0)
    for part in _cached(middle):
        turned[part] += _by(np.abs(inverse[part]), _by(radius[part][:, :, passive], weights[part]))
    largest = (turned / weights).max(axis=1, initial=0.0)
    return LinearClosures(closures, inverse, middle, radius, turned, weights, largest, rounding)


def _bias(
    geometry: Geometry, motion: Motion, linear: LinearClosures, passed: np.ndarray, v: np.ndarray
) -> np.ndarray:
    """Radius (K, passive) of the passive accelerations without acceleration of the motors."""
    closures, passive = linear.closures, geometry.passive
    frames = frames_of(closures.links, balls(motion.q.T, _configurations(geometry, passed).T))
    values, sizes = dense_balls(loop_bias(closures, frames, balls(motion.v.T, v.T)), len(motion.time))
    rest = motion.a[:, passive] - _by(motion.jacobian[:, passive], motion.a[:, geometry.active])
    off = np.abs(_by(linear.inverse, values.T + _by(linear.middle[:, :, passive], rest)))
    sizes = sizes.T + _by(linear.radius[:, :, passive], np.abs(rest))
    return linear.bounded((off + _by(np.abs(linear.inverse), sizes))[:, :, None])[:, :, 0]


def _cached(matrices: np.ndarray) -> list[slice]:
    """Parts of matrices (K, r, c) that fit into the processor's cache with their results."""
    each = max(matrices[0].nbytes, 1) if len(matrices) else 1
    return blocks_of(len(matrices), max(PROOF.cached // each, 1))


def _by(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Matrices (K, r, c) times vectors (K, c)."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])


def _evened(geometry: Geometry, sizes: np.ndarray) -> np.ndarray:
    """Tree displacements (K, nv) in which ball and free joints have one size for all directions: the norm."""
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
