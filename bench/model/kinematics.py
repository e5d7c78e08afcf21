"""Kinematics of the opened tree for all samples at once.

Arrays keep the samples in their last axis: positions (3, N), rotations (3, 3, N), so that every operation
runs along contiguous samples. Coordinates are Pinocchio's: a free joint's position is x y z and a quaternion
x y z w, its velocity is linear then angular, both in the body's own frame.
"""

from dataclasses import dataclass

import numpy as np

from bench.model.geometry import Anchor, Geometry, Joint


@dataclass(frozen=True)
class Frames:
    """Joint frames in the world: rotations (3, 3, N) and origins (3, N) [m], by joint index."""

    rotation: dict[int, np.ndarray]
    origin: dict[int, np.ndarray]
    samples: int


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross product along the first axis; (3, N) by (3, N), or (3, 1) for a constant."""
    return np.stack((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def skew(w: np.ndarray) -> np.ndarray:
    """The matrix (3, 3) with skew(w) x = w cross x."""
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def rotation_of(quaternion: np.ndarray) -> np.ndarray:
    """Rotations (3, 3, N) of unit quaternions (4, N), x y z w."""
    x, y, z, w = quaternion
    return np.stack(
        (
            np.stack((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w))),
            np.stack((2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w))),
            np.stack((2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y))),
        )
    )


def multiply(rotation: np.ndarray, constant: np.ndarray) -> np.ndarray:
    """rotation (3, 3, N) times a constant (3, k): (3, k, N), or (3, N) for a constant vector (3,)."""
    if constant.ndim == 1:
        return constant[0] * rotation[:, 0] + constant[1] * rotation[:, 1] + constant[2] * rotation[:, 2]
    return np.matmul(constant.T, rotation)


def apply(rotation: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """rotation (3, 3, N) times vector (3, N): (3, N)."""
    return rotation[:, 0] * vector[0] + rotation[:, 1] * vector[1] + rotation[:, 2] * vector[2]


def ancestors(geometry: Geometry, joint: int) -> tuple[int, ...]:
    """The joint and all joints between it and the world, root first."""
    chain: list[int] = []
    while joint >= 0:
        chain.append(joint)
        joint = geometry.joints[joint].parent
    return tuple(reversed(chain))


def loop_joints(geometry: Geometry) -> tuple[int, ...]:
    """The joints that move an anchor of a loop, in tree order."""
    ends = [anchor.joint for loop in geometry.loops for anchor in (loop.first, loop.second)]
    return tuple(sorted({joint for end in ends for joint in ancestors(geometry, end)}))


def frames_of(geometry: Geometry, q: np.ndarray, joints: tuple[int, ...] | None = None) -> Frames:
    """Frames of the named joints (all when None) at the configurations q (nq, N)."""
    samples = q.shape[1]
    rotation: dict[int, np.ndarray] = {}
    origin: dict[int, np.ndarray] = {}
    for index in range(len(geometry.joints)) if joints is None else joints:
        joint = geometry.joints[index]
        at = joint.placement
        if joint.parent < 0:
            base = np.broadcast_to(at.translation[:, None], (3, samples))
        else:
            base = origin[joint.parent] + multiply(rotation[joint.parent], at.translation)
        if joint.kind == "hinge":
            k = skew(joint.axis)
            # Rodrigues: a a' + sin q K - cos q K K
            parts = np.hstack(
                (at.rotation @ np.outer(joint.axis, joint.axis), at.rotation @ k, -at.rotation @ k @ k)
            )
            if joint.parent < 0:
                turned = np.broadcast_to(parts[:, :, None], (3, 9, samples))
            else:
                turned = multiply(rotation[joint.parent], parts)
            angle = q[joint.q.start]
            rotation[index] = turned[:, 0:3] + np.sin(angle) * turned[:, 3:6] + np.cos(angle) * turned[:, 6:9]
            origin[index] = base
            continue
        if joint.parent < 0:
            fixed = np.broadcast_to(at.rotation[:, :, None], (3, 3, samples))
        else:
            fixed = multiply(rotation[joint.parent], at.rotation)
        if joint.kind == "slide":
            rotation[index] = fixed
            origin[index] = base + q[joint.q.start] * multiply(fixed, joint.axis)
        elif joint.kind == "ball":
            turn = rotation_of(q[joint.q])
            rotation[index] = np.stack([apply(fixed, turn[:, i]) for i in range(3)], axis=1)
            origin[index] = base
        else:
            rotation[index] = rotation_of(q[joint.q.start + 3 : joint.q.stop])
            origin[index] = q[joint.q.start : joint.q.start + 3]
    return Frames(rotation, origin, samples)


def anchor_point(frames: Frames, anchor: Anchor) -> np.ndarray:
    """World position (3, N) of an anchor."""
    if anchor.joint < 0:
        return np.broadcast_to(anchor.placement.translation[:, None], (3, frames.samples))
    arm = multiply(frames.rotation[anchor.joint], anchor.placement.translation)
    return np.asarray(frames.origin[anchor.joint] + arm)


def anchor_rotation(frames: Frames, anchor: Anchor) -> np.ndarray:
    """World orientation (3, 3, N) of an anchor."""
    if anchor.joint < 0:
        return np.broadcast_to(anchor.placement.rotation[:, :, None], (3, 3, frames.samples))
    return multiply(frames.rotation[anchor.joint], anchor.placement.rotation)


def joint_columns(
    joint: Joint, index: int, frames: Frames, point: np.ndarray
) -> tuple[np.ndarray, np.ndarray | None]:
    """What the joint's velocities do to a point of a body that it moves.

    Returns linear and angular columns, each (3, size, N) in the world; angular is None where it is zero.
    """
    rotation = frames.rotation[index]
    if joint.kind == "slide":
        return multiply(rotation, joint.axis)[:, None], None
    arm = point - frames.origin[index]
    if joint.kind == "hinge":
        axis = multiply(rotation, joint.axis)
        return cross(axis, arm)[:, None], axis[:, None]
    turning = np.stack([cross(rotation[:, k], arm) for k in range(3)], axis=1)
    if joint.kind == "ball":
        return turning, rotation
    return (
        np.concatenate((rotation, turning), axis=1),
        np.concatenate((np.zeros_like(rotation), rotation), axis=1),
    )


@dataclass(frozen=True)
class Rates:
    """Angular velocity, and the accelerations that remain at zero joint accelerations; (3, N) each."""

    angular: dict[int, np.ndarray]
    angular_bias: dict[int, np.ndarray]
    linear_bias: dict[int, np.ndarray]


def rates_of(geometry: Geometry, frames: Frames, v: np.ndarray, joints: tuple[int, ...]) -> Rates:
    """Velocity-product accelerations of the joint frames at the tree velocities v (nv, N)."""
    zero = np.zeros((3, frames.samples))
    angular: dict[int, np.ndarray] = {-1: zero}
    angular_bias: dict[int, np.ndarray] = {-1: zero}
    linear_bias: dict[int, np.ndarray] = {-1: zero}
    for index in joints:
        joint = geometry.joints[index]
        rotation = frames.rotation[index]
        if joint.kind == "free":
            angular[index] = apply(rotation, v[joint.v.start + 3 : joint.v.stop])
            angular_bias[index] = zero
            linear_bias[index] = cross(angular[index], apply(rotation, v[joint.v.start : joint.v.start + 3]))
            continue
        parent = joint.parent
        if parent < 0:
            linear = zero
        else:
            arm = frames.origin[index] - frames.origin[parent]
            linear = linear_bias[parent] + _carried(angular[parent], angular_bias[parent], arm)
        if joint.kind == "slide":
            sliding = multiply(rotation, joint.axis) * v[joint.v.start]
            angular[index], angular_bias[index] = angular[parent], angular_bias[parent]
            linear_bias[index] = linear if parent < 0 else linear + 2.0 * cross(angular[parent], sliding)
            continue
        if joint.kind == "hinge":
            turning = multiply(rotation, joint.axis) * v[joint.v.start]
        else:
            turning = apply(rotation, v[joint.v])
        linear_bias[index] = linear
        if parent < 0:
            angular[index], angular_bias[index] = turning, zero
        else:
            angular[index] = angular[parent] + turning
            angular_bias[index] = angular_bias[parent] + cross(angular[parent], turning)
    return Rates(angular, angular_bias, linear_bias)


def _carried(angular: np.ndarray, angular_bias: np.ndarray, arm: np.ndarray) -> np.ndarray:
    return cross(angular_bias, arm) + cross(angular, cross(angular, arm))


def anchor_bias(rates: Rates, frames: Frames, anchor: Anchor) -> np.ndarray:
    """Acceleration (3, N) of an anchor when all joint accelerations are zero."""
    if anchor.joint < 0:
        return np.zeros((3, frames.samples))
    arm = multiply(frames.rotation[anchor.joint], anchor.placement.translation)
    joint = anchor.joint
    return np.asarray(
        rates.linear_bias[joint] + _carried(rates.angular[joint], rates.angular_bias[joint], arm)
    )
