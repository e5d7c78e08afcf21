"""More motors than degrees of freedom: what they do against one another moves nothing and is seen by no current."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import mujoco

DEPENDENT = (
    1e-4  # of the largest singular value, equalities of unit length: smaller ones are the slack of drawings
)
TAKES_PART = 0.05  # of the largest entry: motors with less do not take part


def redundant_motors(model: mujoco.MjModel, joints: Sequence[str]) -> str | None:
    """Why the motors at these joints are not independent in the home pose; None where they are."""
    import mujoco  # noqa: PLC0415 - slow to import: only once a robot is really read

    data = mujoco.MjData(model)
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    data.qpos[:] = model.qpos0 if key < 0 else model.key_qpos[key]
    mujoco.mj_fwdPosition(model, data)
    rows = _closures(model, data)
    motors = np.array([int(model.joint(joint).dofadr[0]) for joint in joints])
    left = model.nv - _rank(rows)
    if left >= len(motors):
        return None
    passive = np.setdiff1d(np.arange(model.nv), motors)
    over = (
        rows[:, motors] - rows[:, passive] @ np.linalg.lstsq(rows[:, passive], rows[:, motors], DEPENDENT)[0]
    )
    sizes = np.abs(over).max(axis=0)
    bound = [
        repr(joint) for joint, size in zip(joints, sizes, strict=True) if size > TAKES_PART * sizes.max()
    ]
    return (
        f"the loop closures leave {left} degrees of freedom for {len(motors)} motors; those of joint "
        f"{' and '.join(bound)} are not independent (redundant actuation is not supported: what such motors do "
        "against one another moves nothing)"
    )


def _closures(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """Rows (m, nv) of the equalities that are switched on; the longest of each has unit length."""
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
    return rows


def _rank(rows: np.ndarray) -> int:
    values = np.linalg.svd(rows, compute_uv=False)
    return int((values > DEPENDENT * values.max(initial=0.0)).sum())
