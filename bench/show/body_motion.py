"""Where every body of a robot is during a recording, loops closed."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.errors import BenchError
from bench.model.geometry import Geometry, to_mujoco
from bench.model.motion import motion_of
from bench.recording import Recording
from bench.show.geoms import visible_geoms
from bench.signals.processing import estimate_motion, trim
from bench.signals.settings import FilterSettings

FRAME_RATE = 50.0  # Hz: enough for the eye


@dataclass(frozen=True)
class BodyMotion:
    """Poses in the world.

    time (F,) s, as logged; positions (F, nbody, 3) m; quaternions (F, nbody, 4), x y z w; tool_position
    (F, 3) m and tool_quaternion (F, 4), None without a tool; low, high (3,) m: the box that holds all shapes.
    """

    time: np.ndarray
    positions: np.ndarray
    quaternions: np.ndarray
    tool_position: np.ndarray | None
    tool_quaternion: np.ndarray | None
    low: np.ndarray
    high: np.ndarray


def body_motion(
    model: mujoco.MjModel, geometry: Geometry, recording: Recording, settings: FilterSettings
) -> BodyMotion:
    """Filter the positions as the fit did, close the loops and place all bodies, FRAME_RATE times a second.

    Raises BenchError that names the recording and the time of a sample out of reach or singular.
    """
    motion = estimate_motion(recording.position, recording.rate, settings)
    time = trim(recording.time, settings)
    step = max(1, round(recording.rate / FRAME_RATE))
    frames = slice(0, None, step)
    try:
        tree = motion_of(
            geometry,
            time[frames],
            motion.position[frames],
            motion.velocity[frames],
            motion.acceleration[frames],
        )
    except BenchError as error:
        raise BenchError(f"{recording.name}: {error}") from None
    return placed(model, geometry.robot.tool_site, time[frames], to_mujoco(geometry.joints, tree.q))


def placed(model: mujoco.MjModel, tool_site: str | None, time: np.ndarray, qpos: np.ndarray) -> BodyMotion:
    """The bodies at MuJoCo positions qpos (F, nq)."""
    data = mujoco.MjData(model)
    site = -1 if tool_site is None else mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, tool_site)
    geoms = visible_geoms(model)
    center, half = model.geom_aabb[geoms, :3, None], model.geom_aabb[geoms, 3:, None]
    count = len(time)
    positions, quaternions = np.empty((count, model.nbody, 3)), np.empty((count, model.nbody, 4))
    tool_position, tool_rotation = np.empty((count, 3)), np.empty((count, 9))
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for frame in range(count):
        data.qpos[:] = qpos[frame]
        mujoco.mj_kinematics(model, data)
        positions[frame], quaternions[frame] = data.xpos, data.xquat
        if site >= 0:
            tool_position[frame], tool_rotation[frame] = data.site_xpos[site], data.site_xmat[site]
        if len(geoms):
            turn = data.geom_xmat[geoms].reshape(-1, 3, 3)
            middle = data.geom_xpos[geoms] + (turn @ center)[..., 0]
            reach = (np.abs(turn) @ half)[..., 0]
            low = np.minimum(low, (middle - reach).min(axis=0))
            high = np.maximum(high, (middle + reach).max(axis=0))
    if not len(geoms):
        low, high = positions.min(axis=(0, 1)), positions.max(axis=(0, 1))
    return BodyMotion(
        time=time,
        positions=positions,
        quaternions=np.roll(quaternions, -1, axis=2),
        tool_position=tool_position if site >= 0 else None,
        tool_quaternion=_quaternions(tool_rotation) if site >= 0 else None,
        low=low,
        high=high,
    )


def _quaternions(rotations: np.ndarray) -> np.ndarray:
    """Quaternions (F, 4), x y z w, of rotation matrices (F, 9)."""
    quaternions = np.empty((len(rotations), 4))
    for quaternion, rotation in zip(quaternions, rotations, strict=True):
        mujoco.mju_mat2Quat(quaternion, rotation)
    return np.roll(quaternions, -1, axis=1)
