"""The home pose in a robot's MJCF."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import mujoco


def home_qpos(model: "mujoco.MjModel") -> np.ndarray:
    """qpos (nq,) of the keyframe `home`, or the reference pose if there is none, as a copy."""
    import mujoco  # noqa: PLC0415 - slow to import: only once a robot is really read

    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    return np.array(model.qpos0 if key < 0 else model.key_qpos[key])
