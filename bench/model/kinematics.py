"""Kinematics of the opened tree for all samples at once, in the scalars of bench.model.scalars.

Coordinates are Pinocchio's: a free joint's position is x y z and a quaternion x y z w, its velocity is linear
then angular, both in the body's frame; a ball joint's velocity is in the body's frame too. Vectors below
are in the world's axes.
"""

from dataclasses import dataclass

import numpy as np

from bench.model.geometry import Anchor, Geometry, Joint, JointKind
from bench.model.scalars import (
    Matrix,
    Rows,
    Scalar,
    Vector,
    add,
    constant_matrix,
    constant_vector,
    cross,
    dot,
    minus_product,
    plus_product,
    product,
    scaled,
    subtract,
    turned,
)

ZERO: Vector = (0.0, 0.0, 0.0)
IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Link:
    """A joint's constants for kinematics; `square` is K K with K x = axis cross x.

    aligned: whether the joint frame at zero has its parent's orientation.
    """

    index: int
    kind: JointKind
    parent: int
    rotation: Matrix
    aligned: bool
    translation: Vector
    axis: Vector
    along: Matrix
    skew: Matrix
    square: Matrix
    q: int
    v: int


@dataclass(frozen=True)
class End:
    """An anchor of a loop: the joint that carries it (-1: the world), and its pose in that joint's frame."""

    joint: int
    rotation: Matrix
    translation: Vector


@dataclass(frozen=True)
class Frames:
    """Joint frames in the world by joint index: rotations, origins [m], and the axes of hinges and slides.

    q (nq, N): the configurations.
    """

    rotation: dict[int, Matrix]
    origin: dict[int, Vector]
    axis: dict[int, Vector]
    q: Rows


def link_of(index: int, joint: Joint) -> Link:
    """The constants of joint `index`."""
    x, y, z = joint.axis
    rotation = constant_matrix(joint.placement.rotation)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return Link(
        index=index,
        kind=joint.kind,
        parent=joint.parent,
        rotation=rotation,
        aligned=rotation == IDENTITY,
        translation=constant_vector(joint.placement.translation),
        axis=constant_vector(joint.axis),
        along=constant_matrix(np.outer(joint.axis, joint.axis)),
        skew=constant_matrix(skew),
        square=constant_matrix(skew @ skew),
        q=joint.q.start,
        v=joint.v.start,
    )


def end_of(anchor: Anchor) -> End:
    """The constants of an anchor."""
    place = anchor.placement
    return End(anchor.joint, constant_matrix(place.rotation), constant_vector(place.translation))


def ancestors(geometry: Geometry, joint: int) -> tuple[int, ...]:
    """The joint and all joints between it and the world, root first."""
    chain: list[int] = []
    while joint >= 0:
        chain.append(joint)
        joint = geometry.joints[joint].parent
    return tuple(reversed(chain))


def frames_of(links: tuple[Link, ...], q: Rows) -> Frames:
    """Frames of the links (parents first) at the configurations q (nq, N)."""
    frames = Frames({-1: IDENTITY}, {-1: ZERO}, {}, q)
    for link in links:
        if link.kind == "free":
            frames.rotation[link.index] = rotation_of(q[link.q + 3 : link.q + 7])
            frames.origin[link.index] = (q[link.q], q[link.q + 1], q[link.q + 2])
            continue
        parent = frames.rotation[link.parent]
        if parent is IDENTITY:
            base, fixed = add(frames.origin[link.parent], link.translation), link.rotation
        else:
            base = add(frames.origin[link.parent], turned(parent, link.translation))
            fixed = parent if link.aligned else product(parent, link.rotation)
        if link.kind == "ball":
            fixed = product(fixed, rotation_of(q[link.q : link.q + 4]))
        else:
            axis = frames.axis[link.index] = turned(fixed, link.axis)
            if link.kind == "slide":
                base = add(base, scaled(axis, q[link.q]))
            else:
                fixed = product(fixed, turn_of(link, q[link.q]))
        frames.rotation[link.index] = fixed
        frames.origin[link.index] = base
    return frames


def turn_of(link: Link, angle: Scalar) -> Matrix:
    """Rotation of a hinge by an angle (N,). Rodrigues: a a' + sin K - cos K K."""
    sine, cosine = np.sin(angle), np.cos(angle)
    along, skew, square = link.along, link.skew, link.square
    return (
        _turned_column(along[0], skew[0], square[0], sine, cosine),
        _turned_column(along[1], skew[1], square[1], sine, cosine),
        _turned_column(along[2], skew[2], square[2], sine, cosine),
    )


def _turned_column(
    along: Vector, skew: Vector, square: Vector, sine: np.ndarray, cosine: np.ndarray
) -> Vector:
    return (
        minus_product(plus_product(along[0], sine, skew[0]), cosine, square[0]),
        minus_product(plus_product(along[1], sine, skew[1]), cosine, square[1]),
        minus_product(plus_product(along[2], sine, skew[2]), cosine, square[2]),
    )


def rotation_of(quaternion: Rows) -> Matrix:
    """Rotations of unit quaternions (4, N), x y z w."""
    x, y, z, w = quaternion
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz = x2 * x, y2 * y, z2 * z
    xy, xz, yz = x2 * y, x2 * z, y2 * z
    xw, yw, zw = x2 * w, y2 * w, z2 * w
    return (
        (1.0 - (yy + zz), xy + zw, xz - yw),
        (xy - zw, 1.0 - (xx + zz), yz + xw),
        (xz + yw, yz - xw, 1.0 - (xx + yy)),
    )


def end_point(frames: Frames, end: End) -> Vector:
    """World position of an anchor."""
    return add(frames.origin[end.joint], turned(frames.rotation[end.joint], end.translation))


def end_rotation(frames: Frames, end: End) -> Matrix:
    """World orientation of an anchor."""
    return product(frames.rotation[end.joint], end.rotation)


def link_columns(link: Link, frames: Frames, point: Vector) -> list[tuple[int, Vector, Vector]]:
    """Jacobian columns of a joint for a point that it moves: (velocity index, linear, angular) each."""
    if link.kind == "slide":
        return [(link.v, frames.axis[link.index], ZERO)]
    arm = subtract(point, frames.origin[link.index])
    if link.kind == "hinge":
        axis = frames.axis[link.index]
        return [(link.v, cross(axis, arm), axis)]
    rotation, first = frames.rotation[link.index], link.v
    columns: list[tuple[int, Vector, Vector]] = []
    if link.kind == "free":
        columns = [(first + k, rotation[k], ZERO) for k in range(3)]
        first += 3
    return columns + [(first + k, cross(rotation[k], arm), rotation[k]) for k in range(3)]


@dataclass(frozen=True)
class Rates:
    """Angular velocity, and the accelerations at zero joint accelerations."""

    angular: dict[int, Vector]
    angular_bias: dict[int, Vector]
    linear_bias: dict[int, Vector]


def rates_of(links: tuple[Link, ...], frames: Frames, v: list[Scalar]) -> Rates:
    """Velocity-product accelerations of the joint frames at the tree velocities v (nv of them)."""
    rates = Rates({-1: ZERO}, {-1: ZERO}, {-1: ZERO})
    for link in links:
        at, parent = link.index, link.parent
        rotation = frames.rotation[at]
        spin = (v[link.v], v[link.v + 1], v[link.v + 2]) if link.kind in ("ball", "free") else ZERO
        if link.kind == "free":
            rates.angular[at] = turned(rotation, (v[link.v + 3], v[link.v + 4], v[link.v + 5]))
            rates.angular_bias[at] = ZERO
            rates.linear_bias[at] = cross(rates.angular[at], turned(rotation, spin))
            continue
        angular, bias = rates.angular[parent], rates.angular_bias[parent]
        linear = rates.linear_bias[parent]
        if parent >= 0:
            arm = subtract(frames.origin[at], frames.origin[parent])
            linear = add(linear, carried(angular, bias, arm))
        if link.kind == "slide":
            sliding = scaled(frames.axis[at], v[link.v])
            linear = add(linear, scaled(cross(angular, sliding), 2.0))
            rates.angular[at], rates.angular_bias[at] = angular, bias
        else:
            turning = scaled(frames.axis[at], v[link.v]) if link.kind == "hinge" else turned(rotation, spin)
            rates.angular[at] = add(angular, turning)
            rates.angular_bias[at] = add(bias, cross(angular, turning))
        rates.linear_bias[at] = linear
    return rates


def carried(angular: Vector, angular_acceleration: Vector, arm: Vector) -> Vector:
    """Acceleration of a point at `arm` from the origin of a turning frame, less that of the origin.

    Equals w' x r + w x (w x r), in this code w' x r + w (w r) - r (w w).
    """
    along, square = dot(angular, arm), dot(angular, angular)
    turning = cross(angular_acceleration, arm)
    return (
        minus_product(plus_product(turning[0], angular[0], along), square, arm[0]),
        minus_product(plus_product(turning[1], angular[1], along), square, arm[1]),
        minus_product(plus_product(turning[2], angular[2], along), square, arm[2]),
    )


def end_bias(rates: Rates, frames: Frames, end: End) -> Vector:
    """Acceleration of an anchor at zero joint accelerations."""
    if end.joint < 0:
        return ZERO
    arm = turned(frames.rotation[end.joint], end.translation)
    at = end.joint
    return add(rates.linear_bias[at], carried(rates.angular[at], rates.angular_bias[at], arm))
