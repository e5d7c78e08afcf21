"""The moving robot in the viewer: its bodies, the payload, and the tool's path coloured by the error."""

import mujoco
import numpy as np
import rerun as rr

from bench.dataset.payload import Payload
from bench.document.colours import scale_colours
from bench.document.numbers import error_where_moving
from bench.identification.result import CurrentSeries
from bench.viewer.body_motion import BodyMotion, Colour, shapes
from bench.viewer.content import ShownContent

PAYLOAD_DENSITY = 7850.0  # kg/m^3: a payload is drawn as a steel ball of its mass
PAYLOAD_COLOUR = (250, 214, 92)
OUTLINE = (250, 214, 92, 255)
REFERENCE_COLOUR = (120, 134, 150)
PATH_RADIUS = 0.0015  # of the diagonal of the box around the robot's motion
TOP = 99.0  # percentile of the errors at the upper end of the colour scale


def error_share(series: CurrentSeries) -> np.ndarray:
    """RMS error of the moving motors in every row (M,), each relative to the RMS of its current; NaN at standstill."""
    size = np.sqrt(np.mean(series.measured**2, axis=0))
    relative = error_where_moving(series) / np.where(size > 0.0, size, np.nan)
    known = np.isfinite(relative)
    squares = np.where(known, relative, 0.0) ** 2
    with np.errstate(invalid="ignore"):
        return np.asarray(
            np.sqrt(squares.sum(axis=1) / np.where(known.any(axis=1), known.sum(axis=1), np.nan))
        )


def send_robot(
    stream: rr.RecordingStream, content: ShownContent, model: mujoco.MjModel, largest: float
) -> None:
    """Send the bodies with closed loops, a simulated robot in outline, and the tool's path.

    largest: the error share at the upper end of the colour scale.
    """
    robot = f"{content.root}/robot"
    stream.log(robot, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    send_bodies(stream, f"{robot}/bodies", model, content.motion, content.column(content.motion.time))
    if (twin := content.simulated) is not None:
        send_bodies(stream, f"{robot}/simulated", model, twin, content.column(twin.time), OUTLINE)
    if content.motion.tool_position is not None:
        _send_path(stream, content, content.motion.tool_position, largest)


def send_bodies(
    stream: rr.RecordingStream,
    root: str,
    model: mujoco.MjModel,
    motion: BodyMotion,
    column: rr.TimeColumn,
    outline: Colour | None = None,
) -> None:
    """Send the shapes and poses of every body, below the entity `root`; column: the times of the motion."""
    names = [
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body_{body}"
        for body in range(model.nbody)
    ]
    entities = [f"{root}/{rr.escape_entity_path_part(name)}" for name in names]
    for shape in shapes(model, outline):
        stream.log(f"{entities[shape.body]}/{shape.name}", *shape.archetypes, static=True)
    for body in range(1, model.nbody):
        positions, quaternions = motion.positions[:, body], motion.quaternions[:, body]
        if model.body_weldid[body] == 0:  # fixed to the world
            fixed = rr.Transform3D(translation=positions[0], quaternion=rr.Quaternion(xyzw=quaternions[0]))
            stream.log(entities[body], fixed, static=True)
        else:
            _send_poses(stream, entities[body], column, positions, quaternions)


def _send_path(stream: rr.RecordingStream, content: ShownContent, tool: np.ndarray, largest: float) -> None:
    """Send the tool's path, coloured by the error, a dot that moves along it, and the reference path if known."""
    robot = f"{content.root}/robot"
    radius = PATH_RADIUS * float(np.linalg.norm(content.motion.high - content.motion.low))
    rows = np.clip(np.searchsorted(content.series.time, content.motion.time), 0, len(content.series.time) - 1)
    colours = scale_colours(error_share(content.series)[rows] / largest)
    pieces = np.stack((tool[:-1], tool[1:]), axis=1)
    path = rr.LineStrips3D(pieces, colors=colours[:-1], radii=radius)
    stream.log(f"{robot}/tool_path", path, static=True)
    dot = rr.Points3D.columns(positions=tool, colors=colours, radii=np.full(len(tool), 5.0 * radius))
    stream.send_columns(f"{robot}/tool_error", indexes=[content.column(content.motion.time)], columns=dot)
    if content.reference_path is not None:
        wanted = rr.LineStrips3D([content.reference_path], colors=REFERENCE_COLOUR, radii=0.6 * radius)
        stream.log(f"{robot}/reference_path", wanted, static=True)


def send_payload(stream: rr.RecordingStream, content: ShownContent, payload: Payload) -> None:
    """Send a ball of the payload's mass, at its centre of mass if known, else at the tool; nothing without a tool."""
    motion = content.motion
    if motion.tool_position is None or motion.tool_quaternion is None:
        return
    entity = f"{content.root}/robot/payload"
    if payload.mass is None:
        radius = 0.03 * float(np.linalg.norm(motion.high - motion.low))
    else:
        radius = float((3.0 * payload.mass / (4.0 * np.pi * PAYLOAD_DENSITY)) ** (1.0 / 3.0))
    center = np.zeros(3) if payload.center_of_mass is None else payload.center_of_mass
    ball = rr.Ellipsoids3D(
        centers=[center],
        radii=[radius],
        colors=PAYLOAD_COLOUR,
        fill_mode=rr.components.FillMode.Solid,
        labels=payload.name if payload.mass is None else f"{payload.name}, {payload.mass:g} kg",
        show_labels=True,
    )
    stream.log(f"{entity}/ball", ball, static=True)
    column = content.column(motion.time)
    _send_poses(stream, entity, column, motion.tool_position, motion.tool_quaternion)


def _send_poses(
    stream: rr.RecordingStream,
    entity: str,
    column: rr.TimeColumn,
    positions: np.ndarray,
    quaternions: np.ndarray,
) -> None:
    poses = rr.Transform3D.columns(translation=positions, quaternion=quaternions)
    stream.send_columns(entity, indexes=[column], columns=poses)
