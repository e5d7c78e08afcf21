"""An identification for the Rerun viewer: currents, errors, parameters and the moving robot."""

import re
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath

import mujoco
import numpy as np
import rerun as rr

from bench.dataset import Dataset
from bench.errors import BenchError
from bench.estimate.result import CurrentSeries, Identification, relative_error
from bench.files import atomic_path
from bench.model.geometry import Geometry, read_geometry
from bench.payload import Payload
from bench.recording import Recording
from bench.show.blueprint import PARAMETERS, SUMMARY, Motor, Scene, blueprint, eye_of
from bench.show.body_motion import BodyMotion, body_motion
from bench.show.colours import ON_DARK, rgb
from bench.show.geoms import shapes
from bench.show.numbers import USES, Truth, current_unit, error_deviation, judged_error, percent
from bench.show.summary import parameters_markdown, summary_markdown

TIMELINE = "time"
PAYLOAD_DENSITY = 7850.0  # kg/m^3: a payload is drawn as a ball of steel that weighs the same
PAYLOAD_COLOUR = (250, 214, 92)
PATH_COLOUR = (235, 96, 126)
POSITION_COLOURS = ("#5BC99B", "#C39BF0", "#E6D55A", "#F08A6B", "#9FC7C9", "#D0A0A0")


@dataclass(frozen=True)
class _Line:
    """How a series is drawn; width in points."""

    name: str
    colour: str
    width: float


LOGGED = _Line("logged", ON_DARK.logged, 1.0)
MEASURED = _Line("measured, filtered", ON_DARK.measured, 4.0)
MODELLED = _Line("modelled", ON_DARK.modelled, 1.5)
ERROR = _Line("error", ON_DARK.error, 1.2)


@dataclass(frozen=True)
class _Shown:
    """One recording of the dataset, with all that is drawn of it."""

    root: str
    recording: Recording
    series: CurrentSeries
    motion: BodyMotion


def write_rrd(
    path: str | Path, result: Identification, dataset: Dataset, *, truth: Truth | None = None
) -> None:
    """Write the identification of a dataset as an .rrd file, whole or not at all.

    Below the name of each recording lie robot (moving at 50 Hz, loops closed), current/JOINT (logged at the
    log's rate; measured and modelled at the fit's), error/JOINT with the deviation of the fitted errors, and
    position/JOINT; /summary and /parameters hold the answer as text. Every recording starts at time 0.
    truth: true values to compare with, by joint, parameter name or EFFECT:JOINT.PARAMETER.

    Raises BenchError for another suffix than .rrd, and for a result that is not of this dataset.
    """
    if Path(path).suffix.lower() != ".rrd":
        raise BenchError(f"{path}: a Rerun recording is an .rrd file")
    geometry = read_geometry(dataset.robot)
    model = mujoco.MjModel.from_xml_path(str(dataset.robot.model_path))
    shown = _shown(result, dataset, model, geometry)
    motors = _motors(result, geometry)
    spread = error_deviation(result)
    with atomic_path(path) as partial:
        stream = rr.RecordingStream(_application(result.robot, shown))
        stream.save(partial, default_blueprint=blueprint(_scenes(shown, model), motors))
        stream.send_recording_name(f"{result.robot}, {result.method}")
        _send_text(stream, result, truth)
        for one in shown:
            _send_currents(stream, one, motors, spread)
            _send_robot(stream, one, model)
            if one.recording.payload is not None:
                _send_payload(stream, one, dataset.payloads[one.recording.payload])
        stream.flush()
        stream.disconnect()


def _application(robot: str, shown: Sequence[_Shown]) -> str:
    """The viewer keeps one set of views for each application: other recordings are another one."""
    layout = zlib.crc32("\n".join(one.root for one in shown).encode())
    return f"parabench_{re.sub(r'[^A-Za-z0-9]', '_', robot)}_{layout:08x}"


def _shown(
    result: Identification, dataset: Dataset, model: mujoco.MjModel, geometry: Geometry
) -> list[_Shown]:
    by_name = {recording.name: recording for recording in dataset.recordings}
    roots = entity_roots([series.name for series in result.recordings])
    shown = []
    for series in result.recordings:
        recording = by_name.get(series.name)
        if recording is None or recording.current.shape[1] != series.measured.shape[1]:
            raise BenchError(f"{dataset.folder}: has no recording {series.name!r} as the result does")
        motion = body_motion(model, geometry, recording, result.settings)
        shown.append(_Shown(roots[series.name], recording, series, motion))
    return shown


def entity_roots(names: Sequence[str]) -> Mapping[str, str]:
    """The entity of every recording: its file name, without the suffix unless two would be alike."""
    stems = Counter(PurePath(name).stem for name in names)
    return {
        name: rr.new_entity_path([PurePath(name).stem if stems[PurePath(name).stem] == 1 else name])
        for name in names
    }


def _motors(result: Identification, geometry: Geometry) -> list[Motor]:
    kinds = {joint.name: joint.kind for joint in geometry.joints}
    return [
        Motor(
            name=joint,
            entity=rr.escape_entity_path_part(joint),
            current_unit=current_unit(gain.unit),
            position_unit="m" if kinds[joint] == "slide" else "rad",
        )
        for joint, gain in result.drive_gains.items()
    ]


def _scenes(shown: Sequence[_Shown], model: mujoco.MjModel) -> list[Scene]:
    """Tabs of all recordings, seen from the same place."""
    low = np.min([one.motion.low for one in shown], axis=0)
    high = np.max([one.motion.high for one in shown], axis=0)
    eye, target = eye_of(low, high, model.vis.global_.azimuth, model.vis.global_.elevation)
    return [
        Scene(
            title=f"{PurePath(one.series.name).stem} ({USES[one.series.use]})",
            root=one.root,
            errors=tuple(
                percent(relative_error([one.series], j)) for j in range(one.series.measured.shape[1])
            ),
            eye=eye,
            target=target,
            low=float(low[2]),
        )
        for one in shown
    ]


def _send_text(stream: rr.RecordingStream, result: Identification, truth: Truth | None) -> None:
    for entity, text in (
        (SUMMARY, summary_markdown(result, truth)),
        (PARAMETERS, parameters_markdown(result, truth)),
    ):
        stream.log(entity, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)


def _column(time: np.ndarray, start: float) -> rr.TimeColumn:
    """Times in whole nanoseconds since the recording's first sample."""
    nanoseconds = np.rint((time - start) * 1e9).astype("timedelta64[ns]")
    return rr.TimeColumn(TIMELINE, duration=nanoseconds)


def _send_line(
    stream: rr.RecordingStream, entity: str, column: rr.TimeColumn, values: np.ndarray, line: _Line
) -> None:
    style = rr.SeriesLines(names=line.name, colors=rgb(line.colour), widths=line.width)
    stream.log(entity, style, static=True)
    stream.send_columns(entity, indexes=[column], columns=rr.Scalars.columns(scalars=values))


def _send_currents(
    stream: rr.RecordingStream, one: _Shown, motors: Sequence[Motor], spread: np.ndarray
) -> None:
    recording, series = one.recording, one.series
    errors = judged_error(series)
    start = float(recording.time[0])
    logged, fitted = _column(recording.time, start), _column(series.time, start)
    ends = _column(series.time[[0, -1]], start)
    for j, motor in enumerate(motors):
        current, error = f"{one.root}/current/{motor.entity}", f"{one.root}/error/{motor.entity}"
        # The viewer draws in the order of the alphabet, later ones over earlier ones.
        _send_line(stream, f"{current}/logged", logged, recording.current[:, j], LOGGED)
        _send_line(stream, f"{current}/measured", fitted, series.measured[:, j], MEASURED)
        _send_line(stream, f"{current}/modelled", fitted, series.modelled[:, j], MODELLED)
        deviation = rr.Measurements.columns(
            values=np.zeros(2),
            variances=np.full(2, spread[j] ** 2),
            units=[motor.current_unit] * 2,
            names=["± deviation of the fitted errors"] * 2,
            colors=[rgb(ON_DARK.band)] * 2,
        )
        stream.send_columns(f"{error}/deviation", indexes=[ends], columns=deviation)
        _send_line(stream, f"{error}/error", fitted, errors[:, j], ERROR)
        line = _Line(motor.name, POSITION_COLOURS[j % len(POSITION_COLOURS)], 1.5)
        _send_line(stream, f"{one.root}/position/{motor.entity}", logged, recording.position[:, j], line)


def _send_robot(stream: rr.RecordingStream, one: _Shown, model: mujoco.MjModel) -> None:
    robot = f"{one.root}/robot"
    stream.log(robot, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    names = [
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body_{body}"
        for body in range(model.nbody)
    ]
    entities = [f"{robot}/bodies/{rr.escape_entity_path_part(name)}" for name in names]
    for shape in shapes(model):
        stream.log(f"{entities[shape.body]}/{shape.name}", *shape.archetypes, static=True)
    column = _column(one.motion.time, float(one.recording.time[0]))
    for body in range(1, model.nbody):
        positions, quaternions = one.motion.positions[:, body], one.motion.quaternions[:, body]
        if model.body_weldid[body] == 0:  # fixed to the world
            fixed = rr.Transform3D(translation=positions[0], quaternion=rr.Quaternion(xyzw=quaternions[0]))
            stream.log(entities[body], fixed, static=True)
        else:
            _send_poses(stream, entities[body], column, positions, quaternions)
    if one.motion.tool_position is not None:
        reach = float(np.linalg.norm(one.motion.high - one.motion.low))
        path = rr.LineStrips3D([one.motion.tool_position], colors=PATH_COLOUR, radii=0.0012 * reach)
        stream.log(f"{robot}/tool_path", path, static=True)


def _send_payload(stream: rr.RecordingStream, one: _Shown, payload: Payload) -> None:
    """A ball of the payload's mass, at its centre of mass where that is known, else at the tool."""
    motion = one.motion
    if motion.tool_position is None or motion.tool_quaternion is None:
        return
    entity = f"{one.root}/robot/payload"
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
        show_labels=False,
    )
    stream.log(f"{entity}/ball", ball, static=True)
    column = _column(motion.time, float(one.recording.time[0]))
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
