"""The home pose in a robot's MJCF."""

import mujoco
import numpy as np


def home_qpos(model: mujoco.MjModel) -> np.ndarray:
    """qpos (nq,) of the keyframe `home`, or the reference pose if there is none, as a copy."""
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    return np.array(model.qpos0 if key < 0 else model.key_qpos[key])
