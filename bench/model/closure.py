"""Loop closures: residual, Jacobian and velocity-product terms for all samples at once (equations 2-4).

Rows are the stacked loops, `second` minus `first` anchor, in the world: three of position and, for a weld,
three of orientation [m, rad]. Arrays keep the samples last: residual (m, N), Jacobian (m, nv, N).
"""

import numpy as np

from bench.model.geometry import Geometry
from bench.model.kinematics import (
    Frames,
    ancestors,
    anchor_bias,
    anchor_point,
    anchor_rotation,
    apply,
    joint_columns,
    loop_joints,
    rates_of,
    rotation_of,
)


def loop_residual(geometry: Geometry, frames: Frames) -> np.ndarray:
    """What keeps every loop from being closed, (m, N) [m, rad]: f_t and f_p of equation 2."""
    rows = []
    for loop in geometry.loops:
        rows.append(anchor_point(frames, loop.second) - anchor_point(frames, loop.first))
        if loop.kind == "weld":
            first, second = anchor_rotation(frames, loop.first), anchor_rotation(frames, loop.second)
            turn = np.einsum("kin,kjn->ijn", first, second)
            error = 0.5 * np.stack(
                (turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1])
            )
            rows.append(apply(first, error))
    return np.concatenate(rows)


def loop_jacobian(geometry: Geometry, frames: Frames) -> np.ndarray:
    """Derivative of the residual by the tree velocities, (m, nv, N): A_t, A_p, B_t, B_p of equation 3."""
    jacobian = np.zeros((sum(loop.size for loop in geometry.loops), geometry.nv, frames.samples))
    row = 0
    for loop in geometry.loops:
        for sign, anchor in ((-1.0, loop.first), (1.0, loop.second)):
            if anchor.joint < 0:
                continue
            point = anchor_point(frames, anchor)
            for index in ancestors(geometry, anchor.joint):
                joint = geometry.joints[index]
                linear, angular = joint_columns(joint, index, frames, point)
                jacobian[row : row + 3, joint.v] += sign * linear
                if loop.kind == "weld" and angular is not None:
                    jacobian[row + 3 : row + 6, joint.v] += sign * angular
        row += loop.size
    return jacobian


def loop_bias(geometry: Geometry, frames: Frames, v: np.ndarray) -> np.ndarray:
    """Time derivative of the Jacobian times the tree velocities v (nv, N): (m, N), as in equation 4."""
    rates = rates_of(geometry, frames, v, loop_joints(geometry))
    rows = []
    for loop in geometry.loops:
        rows.append(anchor_bias(rates, frames, loop.second) - anchor_bias(rates, frames, loop.first))
        if loop.kind == "weld":
            rows.append(rates.angular_bias[loop.second.joint] - rates.angular_bias[loop.first.joint])
    return np.concatenate(rows)


def solve_passive(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve matrix (m, k, N) x = right (m, r, N) for x (k, r, N), consistent equations, rank k.

    More equations than unknowns (a planar loop in space repeats itself) go through the normal equations.
    Raises numpy.linalg.LinAlgError where a sample is exactly singular.
    """
    a = np.ascontiguousarray(matrix.transpose(2, 0, 1))
    b = np.ascontiguousarray(right.transpose(2, 0, 1))
    if a.shape[1] != a.shape[2]:
        transposed = a.transpose(0, 2, 1)
        a, b = transposed @ a, transposed @ b
    return np.linalg.solve(a, b).transpose(1, 2, 0)


def integrate(geometry: Geometry, q: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Configurations q (nq, N) moved by the tree velocities step (nv, N) over unit time."""
    moved = q.copy()
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            moved[joint.q] += step[joint.v]
            continue
        at = joint.q.start
        if joint.kind == "free":
            moved[at : at + 3] += apply(
                rotation_of(q[at + 3 : at + 7]), step[joint.v.start : joint.v.start + 3]
            )
            at += 3
        moved[at : at + 4] = _turned(q[at : at + 4], step[joint.v.stop - 3 : joint.v.stop])
    return moved


def configuration_rate(geometry: Geometry, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Time derivative (nq, N) of the configuration at the tree velocities v (nv, N)."""
    rate = np.empty_like(q)
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            rate[joint.q] = v[joint.v]
            continue
        at = joint.q.start
        if joint.kind == "free":
            rate[at : at + 3] = apply(rotation_of(q[at + 3 : at + 7]), v[joint.v.start : joint.v.start + 3])
            at += 3
        half = 0.5 * v[joint.v.stop - 3 : joint.v.stop]
        rate[at : at + 4] = _quaternion_product(
            q[at : at + 4], np.concatenate((half, np.zeros_like(half[:1])))
        )
    return rate


def normalised(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """The configurations with unit quaternions, in place."""
    for joint in geometry.joints:
        if joint.kind in ("ball", "free"):
            part = q[joint.q.stop - 4 : joint.q.stop]
            part /= np.sqrt((part * part).sum(axis=0))
    return q


def _turned(quaternion: np.ndarray, rotation_vector: np.ndarray) -> np.ndarray:
    angle = np.sqrt((rotation_vector * rotation_vector).sum(axis=0))
    scale = 0.5 * np.sinc(angle / (2.0 * np.pi))
    step = np.concatenate((rotation_vector * scale, np.cos(0.5 * angle)[None]))
    return _quaternion_product(quaternion, step)


def _quaternion_product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return np.stack(
        (
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        )
    )
