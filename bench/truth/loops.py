"""Gaps of the loops of a simulated machine."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

Array = NDArray[np.float64]
CHUNK = 2000  # poses that are computed at once
POINTS = ("xpos", "xmat", "site_xpos")


def loop_gaps(model: mujoco.MjModel, qpos: Array) -> Array:
    """Distance in m between the two halves of each closed loop, (N, loops), at the poses qpos (N, nq)."""
    batch = Batch(model, min(CHUNK, len(qpos)), 1)
    points = {name: batch.bind(name) for name in POINTS}
    gaps = [np.zeros((0, len(_loops(model))))]
    for start in range(0, len(qpos), CHUNK):
        poses = qpos[start : start + CHUNK]
        count = len(poses)
        batch.bind("qpos")[:count] = poses
        batch.forward(np.arange(count), stage=int(mujoco.mjtStage.mjSTAGE_POS))
        gaps.append(gaps_between(model, {name: point[:count] for name, point in points.items()}))
    return np.concatenate(gaps)


def gaps_between(model: mujoco.MjModel, points: Mapping[str, Array]) -> Array:
    """The same (N, loops) from positions of bodies and sites: MuJoCo's arrays named in `POINTS`, (N, …) each.

    For a weld, the distance of the two points that it joins, without its rotation.
    """
    loops = _loops(model)
    gaps = np.zeros((len(points["xpos"]), len(loops)))
    for column, loop in enumerate(loops):
        near, far = _halves(model, loop, points)
        gaps[:, column] = np.linalg.norm(near - far, axis=1)
    return gaps


def batch_gaps(models: Sequence[mujoco.MjModel], points: Mapping[str, Array]) -> Array:
    """The same (R, samples, loops) for R machines, from positions (R, samples, …)."""
    each = [
        gaps_between(model, {k: point[i] for k, point in points.items()}) for i, model in enumerate(models)
    ]
    return np.stack(each)


def _loops(model: mujoco.MjModel) -> list[int]:
    kinds = (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD))
    return [i for i in range(model.neq) if model.eq_active0[i] and int(model.eq_type[i]) in kinds]


def _halves(model: mujoco.MjModel, loop: int, points: Mapping[str, Array]) -> tuple[Array, Array]:
    """The two points (N, 3), world frame, that equality `loop` (connect or weld) holds together."""
    ids = int(model.eq_obj1id[loop]), int(model.eq_obj2id[loop])
    if model.eq_objtype[loop] == int(mujoco.mjtObj.mjOBJ_SITE):
        return points["site_xpos"][:, ids[0]], points["site_xpos"][:, ids[1]]
    # connect: anchors in body 1 and body 2; weld: anchor in body 2 first, then its position in body 1
    first, second = model.eq_data[loop, 0:3], model.eq_data[loop, 3:6]
    if model.eq_type[loop] == int(mujoco.mjtEq.mjEQ_WELD):
        first, second = second, first
    near, far = (
        points["xpos"][:, body] + points["xmat"][:, body].reshape(-1, 3, 3) @ anchor
        for body, anchor in zip(ids, (first, second), strict=True)
    )
    return near, far
