"""Planned motions for the Rerun viewer: the moving robot, its tool's path, and the positions of its motors."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.dataset.robot import Robot
from bench.document.colours import rgb
from bench.model.geometry import read_geometry, to_mujoco
from bench.model.motion import motion_of
from bench.scenario.trajectory import FourierTrajectory
from bench.viewer.body_motion import FRAME_RATE, placed
from bench.viewer.content import TIMELINE, nanoseconds, rrd_stream
from bench.viewer.scene import PATH_RADIUS, send_bodies

PATH_COLOUR = (86, 180, 233)
LINES = ("#56B4E9", "#E69F00", "#009E73", "#CC79A7", "#F0E442", "#D55E00")


def write_planned_rrd(path: str | Path, robot: Robot, motions: Mapping[str, FourierTrajectory]) -> None:
    """Write motions as an .rrd file, whole or not at all; each has a tab, with NAME/robot and NAME/position."""
    tabs = rrb.Tabs(
        *(
            rrb.Vertical(
                rrb.Spatial3DView(origin=f"{name}/robot", name=f"{name}: robot"),
                rrb.TimeSeriesView(origin=f"{name}/position", name="positions [rad or m]"),
                row_shares=[3, 1],
                name=name,
            )
            for name in motions
        )
    )
    views = rrb.Blueprint(tabs, collapse_panels=True)
    with rrd_stream(path, "parabench_planned", f"{robot.name}, planned", views) as stream:
        for name, trajectory in motions.items():
            _send(stream, name, robot, trajectory)


def _send(stream: rr.RecordingStream, name: str, robot: Robot, trajectory: FourierTrajectory) -> None:
    geometry, model = read_geometry(robot), robot.mjcf_model()
    time = np.arange(int(trajectory.duration * FRAME_RATE) + 1) / FRAME_RATE
    states = trajectory.evaluate(time)
    tree = motion_of(geometry, time, *states)
    bodies = placed(model, robot.tool_site, time, to_mujoco(geometry.joints, tree.q))
    column = rr.TimeColumn(TIMELINE, duration=nanoseconds(time))
    stream.log(f"{name}/robot", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    send_bodies(stream, f"{name}/robot/bodies", model, bodies, column)
    if bodies.tool_position is not None:
        radius = PATH_RADIUS * float(np.linalg.norm(bodies.high - bodies.low))
        strip = rr.LineStrips3D([bodies.tool_position], colors=PATH_COLOUR, radii=radius)
        stream.log(f"{name}/robot/tool_path", strip, static=True)
    for j, joint in enumerate(robot.joints):
        entity = f"{name}/position/{rr.escape_entity_path_part(joint)}"
        stream.log(entity, rr.SeriesLines(names=joint, colors=rgb(LINES[j % len(LINES)])), static=True)
        stream.send_columns(entity, indexes=[column], columns=rr.Scalars.columns(scalars=states[0][:, j]))
