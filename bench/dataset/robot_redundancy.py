"""More motors than degrees of freedom: which of them move independently, in the order of robot.toml."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.basics.errors import BenchError

if TYPE_CHECKING:
    import mujoco

DEPENDENT = (
    1e-4  # of the largest singular value, equalities of unit length: smaller ones are the slack of drawings
)


def independent_motors(model: mujoco.MjModel, joints: Sequence[str]) -> tuple[str, ...]:
    """Of these joints with a motor those that move independently in the home pose, the first ones where there is a
    choice; all of them where there are no more than degrees of freedom.

    Raises BenchError where there are more, and one of these joints cannot move at all.
    """
    import mujoco  # noqa: PLC0415 - slow to import: only once a robot is really read

    data = mujoco.MjData(model)
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    data.qpos[:] = model.qpos0 if key < 0 else model.key_qpos[key]
    mujoco.mj_fwdPosition(model, data)
    _, values, motions = np.linalg.svd(_closures(model, data))
    free = motions[int((values > DEPENDENT * values.max(initial=0.0)).sum()) :]
    if len(free) >= len(joints):
        return tuple(joints)
    still = np.abs(free).max(axis=0, initial=0.0) < DEPENDENT
    chosen: list[str] = []
    places: list[int] = []
    for joint in joints:
        place = int(model.joint(joint).dofadr[0])
        if still[place]:
            raise BenchError(f"joint {joint!r} cannot move in the home pose: the loop closures lock it")
        moves = np.linalg.svd(free[:, [*places, place]], compute_uv=False)
        if len(moves) > len(places) and moves[-1] > DEPENDENT * moves[0]:
            chosen.append(joint)
            places.append(place)
    return tuple(chosen)


def _closures(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """Rows (m, nv) of the equalities that are switched on, the longest of each of unit length."""
    import mujoco  # noqa: PLC0415 - slow to import: only once a robot is really read

    closing = np.asarray(data.efc_type) == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    full = np.zeros((data.nefc, model.nv))
    if mujoco.mj_isSparse(model):
        mujoco.mju_sparse2dense(full, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    else:
        full[:] = np.asarray(data.efc_J).reshape(data.nefc, model.nv)
    rows, owners = full[closing], np.asarray(data.efc_id)[closing]
    for owner in np.unique(owners):
        own = owners == owner
        rows[own] /= max(np.linalg.norm(rows[own], axis=1).max(), np.finfo(float).tiny)
    return np.asarray(rows)
