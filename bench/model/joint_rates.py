"""The rates of joints without a motor as what acts in them sees them.

A rod with ball joints at both ends is free to spin about its line (`bench.model.spin`). Where its balls have friction
or armature and the rod itself next to no inertia about that line, these decide the spin: it is the one for which the
angular velocities in its balls are the smallest, their squares added. That is exact for equal viscous friction and for
equal armature in all balls of the tree that hold the rod, one or two; balls that close a loop have neither.
"""

from dataclasses import dataclass

import numpy as np

from bench.model.geometry import Geometry
from bench.model.motion import Motion
from bench.model.spin import Spin, idle_spins


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
    """The rates of a joint (index), rods spinning as their balls make them."""
    columns = geometry.joints[joint].v
    velocity, acceleration, jacobian = motion.v[:, columns], motion.a[:, columns], motion.jacobian[:, columns]
    spins = idle_spins(geometry) if geometry.joints[joint].kind == "ball" else ()
    for spin in spins:
        if joint not in (spin.joint, *(ball for ball, _ in spin.ends)):
            continue
        members = _members(geometry, motion, spin)
        rate, growth = (_along(geometry, members, rates[:, :, None]) for rates in (motion.v, motion.a))
        axis = members[joint]
        # the frame of a rod that spins otherwise turns otherwise; the frame behind its other end does not
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
    """The spin (N, k) in rates (N, nv, k): less it, the squares of those of the balls are the smallest."""
    along = [
        np.einsum("kd,kdn->kn", axis, rates[:, geometry.joints[ball].v]) for ball, axis in members.items()
    ]
    return np.asarray(np.mean(along, axis=0))


def _turned_back(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """A vector (3,) in frames that are turned by quaternions (N, 4), x y z w: (N, 3)."""
    axis, scalar = quaternion[:, :3], quaternion[:, 3:]
    half = np.cross(vector, axis)
    return np.asarray(vector + 2.0 * (scalar * half + np.cross(half, axis)))
