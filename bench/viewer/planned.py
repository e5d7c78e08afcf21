"""Planned motions for the Rerun viewer: the robot moving, its tool's path, and the positions of its motors."""

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import mujoco
import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.dataset.robot import Robot
from bench.document.colours import rgb
from bench.model.geometry import read_geometry, to_mujoco
from bench.model.motion import motion_of
from bench.viewer.body_motion import FRAME_RATE, placed
from bench.viewer.content import TIMELINE, nanoseconds
from bench.viewer.geoms import shapes

PATH_COLOUR = (86, 180, 233)
PATH_RADIUS = 0.0015  # of the box that the robot stays in
LINES = ("#56B4E9", "#E69F00", "#009E73", "#CC79A7", "#F0E442", "#D55E00")


class JointMotion(Protocol):
    """A motion of the actuated joints over `duration` [s]."""

    @property
    def duration(self) -> float:
        """How long it takes, s."""

    def evaluate(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions, velocities and accelerations (N, n) at time (N,)."""


def write_planned_rrd(path: str | Path, robot: Robot, motions: Mapping[str, JointMotion]) -> None:
    """Write motions by name as an .rrd file, whole or not at all: a tab each, with NAME/robot and NAME/position."""
    if Path(path).suffix.lower() != ".rrd":
        raise BenchError(f"{path}: a Rerun recording is an .rrd file")
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
    with atomic_path(path) as partial:
        stream = rr.RecordingStream("parabench_planned")
        stream.save(partial, default_blueprint=rrb.Blueprint(tabs, collapse_panels=True))
        stream.send_recording_name(f"{robot.name}, planned")
        for name, trajectory in motions.items():
            _send(stream, name, robot, trajectory)
        stream.flush()
        stream.disconnect()


def _send(stream: rr.RecordingStream, name: str, robot: Robot, trajectory: JointMotion) -> None:
    geometry, model = read_geometry(robot), robot.mjcf_model()
    time = np.arange(int(trajectory.duration * FRAME_RATE) + 1) / FRAME_RATE
    states = trajectory.evaluate(time)
    tree = motion_of(geometry, time, *states)
    bodies = placed(model, robot.tool_site, time, to_mujoco(geometry.joints, tree.q))
    column = rr.TimeColumn(TIMELINE, duration=nanoseconds(time))
    stream.log(f"{name}/robot", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    entities = [
        f"{name}/robot/bodies/"
        + rr.escape_entity_path_part(
            mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body_{body}"
        )
        for body in range(model.nbody)
    ]
    for shape in shapes(model):
        stream.log(f"{entities[shape.body]}/{shape.name}", *shape.archetypes, static=True)
    for body in range(1, model.nbody):
        poses = rr.Transform3D.columns(
            translation=bodies.positions[:, body], quaternion=bodies.quaternions[:, body]
        )
        stream.send_columns(entities[body], indexes=[column], columns=poses)
    if bodies.tool_position is not None:
        radius = PATH_RADIUS * float(np.linalg.norm(bodies.high - bodies.low))
        strip = rr.LineStrips3D([bodies.tool_position], colors=PATH_COLOUR, radii=radius)
        stream.log(f"{name}/robot/tool_path", strip, static=True)
    for j, joint in enumerate(robot.joints):
        entity = f"{name}/position/{rr.escape_entity_path_part(joint)}"
        stream.log(entity, rr.SeriesLines(names=joint, colors=rgb(LINES[j % len(LINES)])), static=True)
        stream.send_columns(entity, indexes=[column], columns=rr.Scalars.columns(scalars=states[0][:, j]))
