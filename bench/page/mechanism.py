"""The moving mechanism as bars between points of the world, which the page draws in three dimensions."""

from typing import Any

import numpy as np
import numpy.typing as npt

from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.export.replay.replay import TwinMotion
from bench.identification.result import CurrentSeries
from bench.page.chart_spec import significant
from bench.signals.settings import FilterSettings
from bench.viewer.body_motion import BodyMotion, placed, recorded_motion, visible_geoms
from bench.viewer.scene import TOP, error_share

FRAMES, FEWEST_FRAMES = 400, 60  # enough for a smooth motion
MOST_NUMBERS = 30_000  # of all ends of bars together: about 0.2 MB
DIGITS = 4  # significant, of a position in m: finer than a pixel

Array = npt.NDArray[np.float64]


def mechanism(
    data: Dataset,
    recording: Recording,
    series: CurrentSeries,
    settings: FilterSettings,
    frames: int = FRAMES,
    simulated: TwinMotion | None = None,
) -> dict[str, Any]:
    """A robot's bodies in a recording, with closed loops, and its tool's path with the error of a model, 0 to 1.

    series: of the model in this recording; simulated: a twin to draw with it. Raises BenchError for a sample out of
    reach.
    """
    mjcf = data.robot.mjcf_model()
    motion = recorded_motion(data.robot, recording, settings)
    frames = min(frames, max(FEWEST_FRAMES, MOST_NUMBERS // (6 * len(visible_geoms(mjcf)) or 1)))
    every = max(1, -(-len(motion.time) // frames))
    time = motion.time[::every]
    share = error_share(series)
    known = np.isfinite(share)
    errors = np.interp(time, series.time[known], share[known]) if known.any() else np.zeros(len(time))
    largest = float(np.percentile(share[known], TOP)) if known.any() else 0.0
    tool = None if motion.tool_position is None else motion.tool_position[::every]
    relative = np.clip(errors / largest, 0.0, 1.0) if largest > 0.0 else np.zeros(len(time))
    return {
        "time": significant(time - recording.time[0], 6),
        "low": motion.low.tolist(),
        "high": motion.high.tolist(),
        "bars": _bars(mjcf, motion, every),
        "simulated": [] if simulated is None else _simulated(mjcf, simulated, time),
        "path": None if tool is None else significant(tool.ravel(), DIGITS),
        "error": significant(relative, 3),
        "largest": largest,
    }


def _simulated(mjcf: Any, simulated: TwinMotion, time: Array) -> list[dict[str, Any]]:
    """The bars of a twin in the frames nearest to these times, without those fixed to the world."""
    nearest = np.searchsorted(0.5 * (simulated.time[1:] + simulated.time[:-1]), time)
    motion = placed(mjcf, None, time, simulated.poses[nearest])
    return [bar for bar in _bars(mjcf, motion, 1) if len(bar["from"]) > 3]


def _bars(mjcf: Any, motion: BodyMotion, every: int) -> list[dict[str, Any]]:
    """Every visible shape as a bar along its longest side: radius, m, and both ends, flat lists of x, y, z per frame.

    A shape fixed to the world has one frame.
    """
    bars = []
    for geom in visible_geoms(mjcf).tolist():
        body = int(mjcf.geom_bodyid[geom])
        center, half = mjcf.geom_aabb[geom, :3], mjcf.geom_aabb[geom, 3:]
        longest = int(np.argmax(half))
        radius = float(np.mean(np.delete(half, longest)))
        reach = np.zeros(3)
        reach[longest] = max(0.0, float(half[longest]) - radius)
        turn = np.roll(mjcf.geom_quat[geom], -1)
        local_ends = [mjcf.geom_pos[geom] + _turned(turn, center + sign * reach) for sign in (-1.0, 1.0)]
        frames = slice(0, 1) if mjcf.body_weldid[body] == 0 else slice(0, None, every)
        turns = motion.quaternions[frames, body]
        start, end = (
            significant((motion.positions[frames, body] + _turned(turns, end)).ravel(), DIGITS)
            for end in local_ends
        )
        bars.append({"radius": radius, "from": start, "to": end})
    return bars


def _turned(quaternions: npt.NDArray[np.float64], vector: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """A vector (3,) rotated by unit quaternions (..., 4), x y z w; scipy.spatial takes 0.2 s to import."""
    axis, real = quaternions[..., :3], quaternions[..., 3:]
    across = 2.0 * np.cross(axis, vector)
    return np.asarray(vector + real * across + np.cross(axis, across))
