"""The mechanism in motion, as bars between points of the world: what a page draws in three dimensions."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from bench.basics.errors import BenchError
from bench.basics.progress import Progress
from bench.dataset.dataset import load_dataset
from bench.effects import catalogue_for
from bench.identification.model_file import apply_model, load_model
from bench.model.geometry import read_geometry
from bench.page.thinned import significant
from bench.viewer.body_motion import BodyMotion, body_motion
from bench.viewer.geoms import visible_geoms
from bench.viewer.scene import TOP, error_share

FRAMES = 400  # at most: enough for the eye

Array = npt.NDArray[np.float64]


def machine(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """The bodies of a robot in a recording, loops closed, and its tool's path with the error of a model, 0 to 1.

    Raises BenchError for a recording that is not there, and where a sample is out of reach.
    """
    data = load_dataset(arguments["dataset"])
    saved = load_model(arguments["model"])
    applied = apply_model(data, saved, catalogue_for(data.effect_files))
    name = arguments["recording"]
    found = [series for series in applied.recordings if series.name == name]
    recording = next((one for one in data.recordings if one.name == name), None)
    if recording is None or not found:
        raise BenchError(f"{name}: no such recording")
    mjcf = data.robot.mjcf_model()
    motion = body_motion(mjcf, read_geometry(data.robot), recording, saved.settings)
    every = max(1, -(-len(motion.time) // FRAMES))
    time = motion.time[::every]
    share = error_share(found[0])
    known = np.isfinite(share)
    errors = np.interp(time, found[0].time[known], share[known]) if known.any() else np.zeros(len(time))
    largest = float(np.percentile(share[known], TOP)) if known.any() else 0.0
    tool = None if motion.tool_position is None else motion.tool_position[::every]
    return {
        "time": significant(time - recording.time[0], 6),
        "low": motion.low.tolist(),
        "high": motion.high.tolist(),
        "bars": _bars(mjcf, motion, every),
        "path": None if tool is None else significant(tool.ravel()),
        "error": significant(
            np.clip(errors / largest, 0.0, 1.0) if largest > 0.0 else np.zeros(len(time)), 3
        ),
        "largest": largest,
    }


def _bars(mjcf: Any, motion: BodyMotion, every: int) -> list[dict[str, Any]]:
    """Every visible shape as a bar along its longest side: radius m, and both ends in every frame, x y z after x y z.

    A shape that is fixed to the world has one frame.
    """
    found = []
    for geom in visible_geoms(mjcf).tolist():
        body = int(mjcf.geom_bodyid[geom])
        center, half = mjcf.geom_aabb[geom, :3], mjcf.geom_aabb[geom, 3:]
        longest = int(np.argmax(half))
        radius = float(np.mean(np.delete(half, longest)))
        reach = np.zeros(3)
        reach[longest] = max(0.0, float(half[longest]) - radius)
        turn = Rotation.from_quat(np.roll(mjcf.geom_quat[geom], -1))
        own = [mjcf.geom_pos[geom] + turn.apply(center + sign * reach) for sign in (-1.0, 1.0)]
        frames = slice(0, 1) if mjcf.body_weldid[body] == 0 else slice(0, None, every)
        turns = Rotation.from_quat(motion.quaternions[frames, body])
        ends = [motion.positions[frames, body] + turns.apply(end) for end in own]
        found.append(
            {"radius": radius, "from": significant(ends[0].ravel()), "to": significant(ends[1].ravel())}
        )
    return found
