"""Configurations and velocities: step, normalise, differentiate, interpolate; arrays keep the samples last.

Only ball and free joints need more than addition: a unit quaternion x y z w turns with the angular velocity
in the body's frame, and a free joint's linear velocity is in that frame too.
"""

import numpy as np

from bench.basics.interpolation import PiecewisePolynomial
from bench.model.geometry import Geometry, Joint
from bench.model.kinematics import rotation_of
from bench.model.scalars import Vector, cross, turned


def integrate(geometry: Geometry, q: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Configurations q (nq, N) moved by the tree velocities step (nv, N) over unit time.

    A free joint first shifts, then turns: exact to first order in its step, the other joints to any.
    """
    moved = np.empty_like(q)
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            np.add(q[joint.q.start], step[joint.v.start], out=moved[joint.q.start])
            continue
        if joint.kind == "free":
            at = slice(joint.q.start, joint.q.start + 3)
            moved[at] = q[at] + turned(rotation_of(q[_quaternion(joint)]), _linear(joint, step))
        turn = np.array(step[joint.v.stop - 3 : joint.v.stop])
        angle = np.sqrt((turn * turn).sum(axis=0))
        turn *= 0.5 * np.sinc(angle / (2.0 * np.pi))
        moved[_quaternion(joint)] = _product(q[_quaternion(joint)], turn, np.cos(0.5 * angle))
    return moved


def displacements(geometry: Geometry, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Tree displacements (nv, N) that move configurations first (nq, N) to second; `integrate` undoes it."""
    step = np.empty((geometry.nv, first.shape[1]))
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            step[joint.v.start] = second[joint.q.start] - first[joint.q.start]
            continue
        before, after = first[_quaternion(joint)], second[_quaternion(joint)]
        if joint.kind == "free":
            at = slice(joint.q.start, joint.q.start + 3)
            world = second[at] - first[at]
            rotation = rotation_of(before)
            step[joint.v.start : joint.v.start + 3] = [
                sum(component * along for component, along in zip(axis, world, strict=True))
                for axis in rotation
            ]
        back = before * np.array([[-1.0], [-1.0], [-1.0], [1.0]])
        turn = _product(back, after[:3], after[3])
        turn *= np.where(turn[3] < 0.0, -1.0, 1.0)
        sine = np.linalg.norm(turn[:3], axis=0)
        angle = 2.0 * np.arctan2(sine, turn[3])
        step[joint.v.stop - 3 : joint.v.stop] = turn[:3] * np.where(
            sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 2.0
        )
    return step


def normalised(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """The configurations with unit quaternions, in place."""
    for joint in geometry.joints:
        if joint.kind in ("ball", "free"):
            part = q[_quaternion(joint)]
            part /= np.sqrt((part * part).sum(axis=0))
    return q


def configuration_rates(
    geometry: Geometry, q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """First and second time derivative (nq, N) of the configuration at tree velocities and accelerations."""
    first, second = np.empty_like(q), np.empty_like(q)
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            first[joint.q], second[joint.q] = v[joint.v], a[joint.v]
            continue
        w, dw = v[joint.v.stop - 3 : joint.v.stop], a[joint.v.stop - 3 : joint.v.stop]
        if joint.kind == "free":
            at, rotation = slice(joint.q.start, joint.q.start + 3), rotation_of(q[_quaternion(joint)])
            first[at] = turned(rotation, _linear(joint, v))
            carried = cross((w[0], w[1], w[2]), _linear(joint, v))
            ax, ay, az = (part + turning for part, turning in zip(_linear(joint, a), carried, strict=True))
            second[at] = turned(rotation, (ax, ay, az))
        at, zero = _quaternion(joint), np.zeros(q.shape[1])
        first[at] = _product(q[at], 0.5 * w, zero)
        second[at] = _product(first[at], 0.5 * w, zero) + _product(q[at], 0.5 * dw, zero)
    return first, second


def hermite(time: np.ndarray, q: np.ndarray, first: np.ndarray, second: np.ndarray) -> PiecewisePolynomial:
    """Quintic through configurations q (nq, M) at times (M,) with their first and second derivatives.

    Called with times (K,) it gives (K, nq); quaternions are to be normalised.
    """
    h = np.diff(time)
    p0, v0, a0 = q[:, :-1], first[:, :-1] * h, second[:, :-1] * h * h
    p1, v1, a1 = q[:, 1:], first[:, 1:] * h, second[:, 1:] * h * h
    way = p1 - p0
    coefficients = np.stack(
        (
            (6.0 * way - 3.0 * (v0 + v1) + 0.5 * (a1 - a0)) / h**5,
            (-15.0 * way + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1) / h**4,
            (10.0 * way - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1) / h**3,
            0.5 * second[:, :-1],
            first[:, :-1],
            p0,
        )
    )
    return PiecewisePolynomial(np.ascontiguousarray(coefficients.transpose(0, 2, 1)), time)


def _quaternion(joint: Joint) -> slice:
    return slice(joint.q.stop - 4, joint.q.stop)


def _linear(joint: Joint, v: np.ndarray) -> Vector:
    return v[joint.v.start], v[joint.v.start + 1], v[joint.v.start + 2]


def _product(quaternion: np.ndarray, vector: np.ndarray, scalar: np.ndarray) -> np.ndarray:
    """Quaternion (4, N) times the one of a vector part (3, N) and a scalar part (N,)."""
    ax, ay, az, aw = quaternion
    bx, by, bz = vector
    return np.stack(
        (
            aw * bx + ax * scalar + ay * bz - az * by,
            aw * by - ax * bz + ay * scalar + az * bx,
            aw * bz + ax * by - ay * bx + az * scalar,
            aw * scalar - ax * bx - ay * by - az * bz,
        )
    )
