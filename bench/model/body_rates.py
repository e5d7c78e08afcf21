"""Velocities and accelerations of the bodies of the opened tree, each in its axes, for all samples at once.

The scalars are those of bench.model.scalars. Angular velocity w, angular acceleration w' and acceleration a of a
joint frame's origin, less gravity, follow from those of the joint before it; so do the velocities that unit speed
of one motor gives. Source of the recursion: W. Khalil and E. Dombre, "Modeling, Identification and Control of
Robots", 2002, chapter 9.

A rod with ball joints at both ends is free to spin about its line (`bench.model.spin`). If its balls have friction or
armature, and the rod has almost no inertia about that line, these determine the spin: it minimises the sum of squares
of the angular velocities in its balls. This is exact for equal viscous friction and for equal armature in all balls of
the tree that hold the rod, one or two; balls that close a loop have neither.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.model.geometry import Geometry
from bench.model.kinematics import ZERO, Link, carried, rotation_of, turn_of
from bench.model.motion import Motion
from bench.model.scalars import Matrix, Rows, Scalar, Vector, add, cross, minus, scaled, turned, turned_back
from bench.model.spin import Spin, idle_spins


@dataclass(frozen=True)
class Twist:
    """Angular velocity of a joint frame and velocity of its origin, for unit speed of one motor."""

    angular: Vector
    linear: Vector


@dataclass(frozen=True)
class BodyRates:
    """Rates of one joint frame, in its axes: w [1/s], w' [1/s2], a less gravity [m/s2], and a twist for every motor."""

    angular: Vector
    turning: Vector
    acceleration: Vector
    twists: tuple[Twist, ...]


def body_rates(
    links: Sequence[Link],
    gravity: Vector,
    q: Rows,
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    motors: Sequence[Sequence[Scalar]],
) -> dict[int, BodyRates]:
    """Rates by joint index of the links (parents first) at configurations q (nq, N), tree velocities v (nv),
    accelerations a (nv) and, for every motor, the tree velocities at its unit speed (nv).
    """
    x, y, z = gravity
    resting = minus(0.0, x), minus(0.0, y), minus(0.0, z)
    rates = {-1: BodyRates(ZERO, ZERO, resting, (Twist(ZERO, ZERO),) * len(motors))}
    for link in links:
        if link.kind == "free":
            rates[link.index] = _free(link, rates[-1].acceleration, q, v, a, motors)
        else:
            rates[link.index] = _carried_on(link, rates[link.parent], q, v, a, motors)
    return rates


def _free(
    link: Link,
    resting: Vector,
    q: Rows,
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    motors: Sequence[Sequence[Scalar]],
) -> BodyRates:
    linear, angular = _three(v, link.v), _three(v, link.v + 3)
    acceleration = add(_three(a, link.v), cross(angular, linear))
    rotation = rotation_of(q[link.q + 3 : link.q + 7])
    return BodyRates(
        angular,
        _three(a, link.v + 3),
        add(acceleration, turned_back(rotation, resting)),
        tuple(Twist(_three(unit, link.v + 3), _three(unit, link.v)) for unit in motors),
    )


def _carried_on(
    link: Link,
    parent: BodyRates,
    q: Rows,
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    motors: Sequence[Sequence[Scalar]],
) -> BodyRates:
    arm = link.translation
    if link.kind == "slide":
        arm = add(arm, turned(link.rotation, scaled(link.axis, q[link.q])))
        joint_rotation: Matrix | None = None
    elif link.kind == "hinge":
        joint_rotation = turn_of(link, q[link.q])
    else:
        joint_rotation = rotation_of(q[link.q : link.q + 4])

    def back(vector: Vector) -> Vector:
        fixed = vector if link.aligned else turned_back(link.rotation, vector)
        return fixed if joint_rotation is None else turned_back(joint_rotation, fixed)

    def at(rates: Sequence[Scalar]) -> Vector:
        return _three(rates, link.v) if link.kind == "ball" else scaled(link.axis, rates[link.v])

    before = back(parent.angular)
    turning = back(parent.turning)
    acceleration = back(add(parent.acceleration, carried(parent.angular, parent.turning, arm)))
    twists = [
        (back(twist.angular), back(add(twist.linear, cross(twist.angular, arm))), at(unit))
        for twist, unit in zip(parent.twists, motors, strict=True)
    ]
    speed, growth = at(v), at(a)
    if link.kind == "slide":
        sliding = add(growth, scaled(cross(before, speed), 2.0))
        along = tuple(Twist(angular, add(linear, unit)) for angular, linear, unit in twists)
        return BodyRates(before, turning, add(acceleration, sliding), along)
    return BodyRates(
        add(before, speed),
        add(add(turning, growth), cross(before, speed)),
        acceleration,
        tuple(Twist(add(angular, unit), linear) for angular, linear, unit in twists),
    )


def _three(values: Sequence[Scalar], first: int) -> Vector:
    return values[first], values[first + 1], values[first + 2]


@dataclass(frozen=True)
class JointRates:
    """Rates of one joint, in its d coordinates: 1 of a hinge or slide, 3 of a ball joint, in the frame of its body.

    velocity and acceleration (N, d), rad/s or m/s and their rates; jacobian (N, d, n): that velocity for the active
    joints' velocities.
    """

    velocity: np.ndarray
    acceleration: np.ndarray
    jacobian: np.ndarray


def joint_rates(geometry: Geometry, motion: Motion, joint: int) -> JointRates:
    """The rates of a joint (index), with the spin of rods."""
    columns = geometry.joints[joint].v
    velocity, acceleration, jacobian = motion.v[:, columns], motion.a[:, columns], motion.jacobian[:, columns]
    spins = idle_spins(geometry) if geometry.joints[joint].kind == "ball" else ()
    for spin in spins:
        if joint not in (spin.joint, *(ball for ball, _ in spin.ends)):
            continue
        members = _members(geometry, motion, spin)
        rate, growth = (_along(geometry, members, rates[:, :, None]) for rates in (motion.v, motion.a))
        axis = members[joint]
        # the spin turns the frame of the rod, but not the frame behind its other end
        bend = np.cross(axis, velocity) if joint == spin.joint else np.cross(velocity, axis)
        velocity = velocity - rate * axis
        acceleration = acceleration - growth * axis + rate * bend
        jacobian = jacobian - axis[:, :, None] * _along(geometry, members, motion.jacobian)[:, None]
    return JointRates(velocity, acceleration, jacobian)


def _members(geometry: Geometry, motion: Motion, spin: Spin) -> dict[int, np.ndarray]:
    """The angular velocities (N, 3) of a rod's balls (indices) for a unit spin of the rod."""
    members = {}
    if geometry.joints[spin.joint].kind == "ball":
        members[spin.joint] = np.broadcast_to(spin.axis, (len(motion.time), 3))
    for ball, axis in spin.ends:
        members[ball] = -_turned_back(motion.q[:, geometry.joints[ball].q], axis)
    return members


def _along(geometry: Geometry, members: dict[int, np.ndarray], rates: np.ndarray) -> np.ndarray:
    """The spin (N, k) to subtract from rates (N, nv, k), so that the balls' squares are smallest."""
    along = [
        np.einsum("kd,kdn->kn", axis, rates[:, geometry.joints[ball].v]) for ball, axis in members.items()
    ]
    return np.asarray(np.mean(along, axis=0))


def _turned_back(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """A vector (3,) in frames that are turned by quaternions (N, 4), x y z w: (N, 3)."""
    axis, scalar = quaternion[:, :3], quaternion[:, 3:]
    half = np.cross(vector, axis)
    return np.asarray(vector + 2.0 * (scalar * half + np.cross(half, axis)))
