"""Poses with all loops closed, and the inertia and weight at the actuated joints in them."""

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError

Array = NDArray[np.float64]
Indices = NDArray[np.signedinteger]


def as_slice(indices: Indices) -> slice | None:
    """The slice equivalent to indices (m,) that rise by a constant step; None for other indices."""
    if len(indices) == 1:
        return slice(int(indices[0]), int(indices[0]) + 1)
    steps = np.diff(indices)
    if steps[0] <= 0 or (steps != steps[0]).any():
        return None
    return slice(int(indices[0]), int(indices[-1]) + 1, int(steps[0]))


def live_columns(source: Array, indices: Indices) -> tuple[Array, Callable[[], object] | None]:
    """Columns of source (R, …) as (R, m), and a function that updates them; None if they are a view."""
    columns = as_slice(indices)
    if columns is not None:
        return source[:, columns], None
    copy = source[:, indices]
    return copy, lambda: np.take(source, indices, axis=1, out=copy)


CLOSED = 1e-12  # m: loops closed to rounding
REPEATED = 1e-5  # m or rad: largest disagreement of redundant closures, which then cannot close to rounding
STILL = 1e-13  # rad or m: a smaller step of Newton's method counts as convergence
LARGEST_MOVE = 0.02  # rad or m of an actuated joint between two solutions, so that the branch is kept


def loop_rows(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Array, Array]:
    """Gaps of all equalities (m,), m and rad, and their Jacobian (m, nv), at data.qpos."""
    mujoco.mj_fwdPosition(model, data)
    equality = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    jacobian = np.asarray(data.efc_J).reshape(data.nefc, model.nv)
    return np.array(data.efc_pos[equality]), np.array(jacobian[equality])


def assembled(model: mujoco.MjModel, home: Array, dofs: Indices, target: Array) -> Array:
    """Pose (nq,) with the actuated joints at `target` (n,) and all loops closed, continued from `home` (nq,).

    dofs: velocity indices (n,) of the actuated joints. The actuated joints move in small steps, and Newton's
    method closes the loops after each: the assembly mode is that of `home`.
    Raises BenchError if the loops do not close.
    """
    data = mujoco.MjData(model)
    data.qpos[:] = home
    joints = model.dof_jntid[dofs]
    address = model.jnt_qposadr[joints]
    start = np.array(data.qpos[address])
    count = max(1, int(np.ceil(np.abs(target - start).max() / LARGEST_MOVE)))
    passive = np.setdiff1d(np.arange(model.nv), dofs)
    for share in np.arange(1, count + 1) / count:
        data.qpos[address] = target if share == 1 else start + share * (target - start)
        close_loops(model, data, passive)
    return np.array(data.qpos)


def close_loops(model: mujoco.MjModel, data: mujoco.MjData, passive: Indices) -> Array:
    """Close the loops by moving the passive joints (velocity indices); data.qpos is changed in place.

    Returns their Jacobian (m, nv) in the closed pose. Raises BenchError if they do not close.
    """
    for _ in range(20):
        gap, jacobian = loop_rows(model, data)
        if gap.size == 0 or np.abs(gap).max() < CLOSED:
            return jacobian
        move = np.zeros(model.nv)
        move[passive] = -np.linalg.lstsq(jacobian[:, passive], gap, rcond=None)[0]
        if np.abs(move).max() < STILL and np.abs(gap).max() < REPEATED:
            return jacobian
        qpos = np.array(data.qpos)
        mujoco.mj_integratePos(model, qpos, move, 1.0)
        data.qpos[:] = qpos
    raise BenchError(
        f"the loops do not close at the start of the trajectory: {np.abs(gap).max():.2g} m remain"
    )


def reduced_inertia(model: mujoco.MjModel, qpos: Array, dofs: Indices) -> Array:
    """The inertia matrix (n, n) reduced to the actuated joints at qpos (nq,), loops closed; kg·m² or kg."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    follow = following(model, data, dofs)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return follow.T @ full @ follow


def felt_inertia(model: mujoco.MjModel, qpos: Array, dofs: Indices, leading: int) -> Array:
    """The effective inertia (n,) at each actuated joint at qpos (nq,), loops closed; kg·m² or kg.

    For the first `leading` joints, which move independently, the others of them are held. For a joint of a redundant
    motor, all other motors are without torque.
    """
    reduced = reduced_inertia(model, qpos, dofs[:leading])
    if leading == len(dofs):
        return np.diag(reduced)
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    follow = following(model, data, dofs[:leading])[dofs[leading:]]
    mobility = (follow * np.linalg.solve(reduced, follow.T).T).sum(axis=1)
    return np.append(np.diag(reduced), 1.0 / mobility)


def holding_torque(model: mujoco.MjModel, qpos: Array, dofs: Indices) -> Array:
    """Torques or forces (n,) of the actuated joints that hold the machine's weight at qpos (nq,)."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    follow = following(model, data, dofs)
    mujoco.mj_fwdVelocity(model, data)
    return follow.T @ data.qfrc_bias


def following(model: mujoco.MjModel, data: mujoco.MjData, dofs: Indices) -> Array:
    """Velocities (nv, n) of all joints for a unit velocity of each actuated joint, at data.qpos, loops closed."""
    _, jacobian = loop_rows(model, data)
    return followed(jacobian, dofs, np.setdiff1d(np.arange(model.nv), dofs))


def followed(jacobian: Array, dofs: Indices, passive: Indices) -> Array:
    """The same from the Jacobian (m, nv) of the loops; passive: velocity indices of the other joints."""
    follow = np.zeros((jacobian.shape[1], len(dofs)))
    follow[dofs] = np.eye(len(dofs))
    follow[passive] = -np.linalg.lstsq(jacobian[:, passive], jacobian[:, dofs], rcond=None)[0]
    return follow
