"""More motors than degrees of freedom: the motion tells the sum of their powers, not what each of them gives."""

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
    rows, owners = _closures(model, data)
    motors = np.array([int(model.joint(joint).dofadr[0]) for joint in joints])
    left = model.nv - _rank(rows)
    if left >= len(motors):
        return None
    combined = _among_motors(rows[:, np.setdiff1d(np.arange(model.nv), motors)])
    between = combined.T @ rows[:, motors]  # equations that hold between the motors alone
    sizes = np.abs(between).max(axis=0)
    bound = [
        repr(joint) for joint, size in zip(joints, sizes, strict=True) if size > TAKES_PART * sizes.max()
    ]
    parts = np.abs(combined @ np.linalg.svd(between)[0][:, 0])
    through = [_label(model, one) for one in np.unique(owners[parts > TAKES_PART * parts.max()]).tolist()]
    return (
        f"the loop closures leave {left} degrees of freedom for {len(motors)} motors; those of joint "
        f"{' and '.join(bound)} are not independent, through {' and '.join(through)} (redundant actuation is not "
        "supported: the motion does not tell what each of such motors gives)"
    )


def _among_motors(passive: np.ndarray) -> np.ndarray:
    """Combinations (m, k) of rows in which no passive joint is left, from their columns passive (m, p)."""
    if not passive.shape[1]:
        return np.eye(len(passive))
    combinations, values, _ = np.linalg.svd(passive)
    return np.asarray(combinations[:, int((values > DEPENDENT * values.max(initial=0.0)).sum()) :])


def _label(model: mujoco.MjModel, equality: int) -> str:
    """Kind and name of an equality; of a joint equality, its joints too."""
    import mujoco  # noqa: PLC0415 - slow to import: only once a robot is really read

    kind = mujoco.mjtEq(int(model.eq_type[equality])).name.removeprefix("mjEQ_").lower()
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_EQUALITY, equality) or f"equality_{equality}"
    if kind != "joint":
        return f"{kind} equality {name!r}"
    ids = (int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality]))
    held = " and ".join(repr(model.joint(one).name) for one in ids if one >= 0)
    return f"joint equality {name!r} of {held}"


def _closures(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[np.ndarray, np.ndarray]:
    """Rows (m, nv) of the equalities that are switched on, the longest of each of unit length, and whose they are."""
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
    return rows, owners


def _rank(rows: np.ndarray) -> int:
    values = np.linalg.svd(rows, compute_uv=False)
    return int((values > DEPENDENT * values.max(initial=0.0)).sum())
