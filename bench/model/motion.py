"""From measured active joints to the motion of every joint: position, velocity, acceleration (eqs. 2-4)."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from bench.errors import BenchError
from bench.model.closure import (
    configuration_rate,
    integrate,
    loop_bias,
    loop_jacobian,
    loop_residual,
    normalised,
    solve_passive,
)
from bench.model.follow import advance, make_follower
from bench.model.geometry import Geometry
from bench.model.kinematics import Frames, frames_of, loop_joints

CLOSED = 1e-9  # m or rad: loops closed at every sample
TRAVEL = 0.2  # active travel between followed nodes, rad, or in units of the robot's length for a slide
STRIDE = 8  # samples between the nodes of the middle level
BLOCK = 2048  # samples worked on together: what fits into a processor's cache
LARGEST_AMPLIFICATION = (
    200.0  # rad/rad, m/rad ...: passive speed for active speed, beyond which it is singular
)
LARGEST_CORRECTION = 0.05  # m or rad: between an interpolated pose and the closed one
MOST_ITERATIONS = 6


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
    geometry: Geometry, time: np.ndarray, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
) -> Motion:
    """Close all loops along a trajectory of the active joints, each (N, n), positions as logged.

    The closures are followed continuously from the home pose. Raises BenchError that names the time of a
    sample which is out of reach or singular.
    """
    active = (position - geometry.active_offset).T
    if not geometry.loops:
        q = np.empty((geometry.nq, len(time)))
        q[geometry.active_configuration] = active
        return rates_at(geometry, time, q, velocity.T, acceleration.T)
    middle = _pose_guess(geometry, time, active, velocity.T)
    parts = []
    for start in range(0, len(time), BLOCK):
        block = slice(start, start + BLOCK)
        q = middle(time[block])
        q[geometry.active_configuration] = active[:, block]
        q, frames = _closed(geometry, time[block], normalised(geometry, q))
        parts.append((q, *_rates(geometry, time[block], frames, velocity[block].T, acceleration[block].T)))
    return _assembled(time, [np.concatenate(part, axis=-1) for part in zip(*parts, strict=True)])


def rates_at(
    geometry: Geometry, time: np.ndarray, q: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
) -> Motion:
    """The motion at closed poses q (nq, N), from active velocities and accelerations, each (n, N)."""
    frames = frames_of(geometry, q, loop_joints(geometry))
    return _assembled(time, [q, *_rates(geometry, time, frames, velocity, acceleration)])


def _assembled(time: np.ndarray, parts: list[np.ndarray]) -> Motion:
    q, v, a, jacobian = parts
    return Motion(time, q.T.copy(), v.T.copy(), a.T.copy(), np.ascontiguousarray(jacobian.transpose(2, 0, 1)))


class _Guess:
    """Cubic Hermite interpolation of closed poses; (nq, N) at the times asked."""

    def __init__(self, time: np.ndarray, q: np.ndarray, rate: np.ndarray) -> None:
        self._spline = CubicHermiteSpline(time, q.T, rate.T) if len(time) > 1 else None
        self._only = q[:, :1]

    def __call__(self, time: np.ndarray) -> np.ndarray:
        if self._spline is None:
            return np.repeat(self._only, len(time), axis=1)
        return np.ascontiguousarray(self._spline(time).T)


def _pose_guess(geometry: Geometry, time: np.ndarray, active: np.ndarray, velocity: np.ndarray) -> _Guess:
    """Coarse to fine: followed nodes, then every STRIDE-th sample closed from their interpolation."""
    nodes = _node_indices(geometry, active)
    followed = _followed(geometry, time, active, nodes)
    guess = _through(geometry, time[nodes], followed, velocity[:, nodes])
    between = np.unique(np.append(np.arange(0, len(time), STRIDE), len(time) - 1))
    q = guess(time[between])
    q[geometry.active_configuration] = active[:, between]
    q, _ = _closed(geometry, time[between], normalised(geometry, q))
    return _through(geometry, time[between], q, velocity[:, between])


def _through(geometry: Geometry, time: np.ndarray, q: np.ndarray, velocity: np.ndarray) -> _Guess:
    v = _velocities(
        geometry, time, loop_jacobian(geometry, frames_of(geometry, q, loop_joints(geometry))), velocity
    )
    return _Guess(time, q, configuration_rate(geometry, q, v))


def robot_length(geometry: Geometry) -> float:
    """The largest distance within a link [m]: what a slide's travel is compared with."""
    places = [joint.placement for joint in geometry.joints]
    places += [anchor.placement for loop in geometry.loops for anchor in (loop.first, loop.second)]
    return max([float(np.linalg.norm(place.translation)) for place in places] + [0.1])


def _node_indices(geometry: Geometry, active: np.ndarray) -> np.ndarray:
    """Samples between which the active joints travel no further than TRAVEL, the first and last included."""
    slides = {joint.v.start for joint in geometry.joints if joint.kind == "slide"}
    scale = np.array([1.0 / robot_length(geometry) if int(i) in slides else 1.0 for i in geometry.active])
    travel = np.append(0.0, np.cumsum(np.abs(np.diff(active * scale[:, None], axis=1)).sum(axis=0)))
    count = int(np.ceil(travel[-1] / TRAVEL)) + 1
    chosen = np.searchsorted(travel, np.linspace(0.0, travel[-1], count))
    last = active.shape[1] - 1
    return np.unique(np.concatenate(([0], np.clip(chosen, 0, last), [last])))


def _followed(geometry: Geometry, time: np.ndarray, active: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    follower = make_follower(geometry)
    q = geometry.home
    poses = np.empty((geometry.nq, len(nodes)))
    for i, node in enumerate(nodes):
        q, share = advance(follower, q, active[:, node])
        if share < 1.0:
            reached = q[geometry.active_configuration] + geometry.active_offset
            raise _unreachable(geometry, time[node], active[:, node] + geometry.active_offset, reached)
        poses[:, i] = q
    return poses


def _unreachable(geometry: Geometry, time: float, wanted: np.ndarray, reached: np.ndarray) -> BenchError:
    names = [actuator.joint for actuator in geometry.robot.actuators]
    at = ", ".join(f"{name} = {value:.4g}" for name, value in zip(names, wanted, strict=True))
    near = ", ".join(f"{value:.4g}" for value in reached)
    return BenchError(
        f"t = {time:.4f} s: the loops of {geometry.robot.name} cannot be closed at {at} "
        f"(singular or out of reach; last closed at {near})"
    )


def _closed(geometry: Geometry, time: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, Frames]:
    """Newton on all samples together, from poses that are nearly closed."""
    joints, passive = loop_joints(geometry), geometry.passive
    moved = np.zeros(q.shape[1])
    for _ in range(MOST_ITERATIONS):
        frames = frames_of(geometry, q, joints)
        residual = loop_residual(geometry, frames)
        open_by = np.abs(residual).max(axis=0)
        if open_by.max() < CLOSED:
            return q, frames
        step = np.zeros((geometry.nv, q.shape[1]))
        try:
            matrix = loop_jacobian(geometry, frames)[:, passive]
            step[passive] = solve_passive(matrix, -residual[:, None])[:, 0]
        except np.linalg.LinAlgError:
            raise _singular(geometry, time, int(np.argmax(open_by))) from None
        moved += np.abs(step).max(axis=0)
        if not moved.max() < LARGEST_CORRECTION:
            raise _singular(geometry, time, int(np.argmax(moved)))
        q = integrate(geometry, q, step)
    raise _singular(geometry, time, int(np.argmax(open_by)))


def _singular(geometry: Geometry, time: np.ndarray, sample: int) -> BenchError:
    return BenchError(
        f"t = {time[sample]:.4f} s: {geometry.robot.name} is at or near a singular pose; its loop closures "
        "do not determine the passive joints there"
    )


def _velocities(
    geometry: Geometry, time: np.ndarray, jacobian: np.ndarray, velocity: np.ndarray
) -> np.ndarray:
    return np.einsum("vjn,jn->vn", _amplification(geometry, time, jacobian), velocity)


def _amplification(geometry: Geometry, time: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """J_t, J_p (nv, n, N) of equation 3."""
    passive, active = geometry.passive, geometry.active
    full = np.zeros((geometry.nv, len(active), jacobian.shape[2]))
    full[active, np.arange(len(active))] = 1.0
    try:
        full[passive] = solve_passive(jacobian[:, passive], -jacobian[:, active])
    except np.linalg.LinAlgError:
        raise _singular(geometry, time, _most_singular(jacobian[:, passive])) from None
    largest = np.abs(full).max(axis=(0, 1))
    if not largest.max() < LARGEST_AMPLIFICATION:
        raise _singular(geometry, time, int(np.argmax(largest)))
    return full


def _most_singular(matrix: np.ndarray) -> int:
    return int(np.argmin(np.linalg.svd(matrix.transpose(2, 0, 1), compute_uv=False)[:, -1]))


def _rates(
    geometry: Geometry,
    time: np.ndarray,
    frames: Frames,
    velocity: np.ndarray,
    acceleration: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    if not geometry.loops:
        amplification = np.zeros((geometry.nv, len(geometry.active), len(time)))
        amplification[geometry.active, np.arange(len(geometry.active))] = 1.0
        v, a = np.zeros((2, geometry.nv, len(time)))
        v[geometry.active], a[geometry.active] = velocity, acceleration
        return v, a, amplification
    jacobian = loop_jacobian(geometry, frames)
    amplification = _amplification(geometry, time, jacobian)
    v = np.einsum("vjn,jn->vn", amplification, velocity)
    a = np.einsum("vjn,jn->vn", amplification, acceleration)
    bias = loop_bias(geometry, frames, v)
    a[geometry.passive] += solve_passive(jacobian[:, geometry.passive], -bias[:, None])[:, 0]
    return v, a, amplification
