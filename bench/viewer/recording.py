"""An identification for the Rerun viewer: the moving robot, currents, errors, torques, phases and parameters."""

import re
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePath

import mujoco
import numpy as np
import rerun as rr

from bench.basics.errors import BenchError
from bench.basics.joint_units import drive_unit, joint_units
from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.document.markdown.tables import parameters_markdown, summary_markdown
from bench.document.numbers import USES, Truth, error_std, error_where_moving, percent
from bench.identification.result import Identification, relative_error
from bench.model.geometry import Geometry, read_geometry
from bench.viewer.blueprint import PARAMETERS, SUMMARY, Scene, blueprint, eye_of, side_by_side
from bench.viewer.body_motion import BodyMotion, body_motion, placed, tool_path
from bench.viewer.content import Motor, ShownContent, rrd_stream
from bench.viewer.context import KnownTruth, ViewContext
from bench.viewer.scene import TOP, error_share, send_payload, send_robot
from bench.viewer.tracks import send_currents, send_phases, send_steps, send_tool, send_torques

REFERENCE_COLUMN = "reference."  # prefix of a log's columns with the controller's references


@dataclass(frozen=True)
class ViewedRun:
    """One of several identifications shown side by side; title: a few words that distinguish it."""

    title: str
    result: Identification
    dataset: Dataset
    context: ViewContext = field(default_factory=ViewContext)


@dataclass(frozen=True, eq=False)
class _Run:
    """One identification with everything shown of it. prefix: of its entities."""

    viewed: ViewedRun
    prefix: str
    model: mujoco.MjModel
    motors: list[Motor]
    shown: list[ShownContent]


def write_rrd(
    path: str | Path,
    result: Identification,
    dataset: Dataset,
    *,
    truth: Truth | None = None,
    context: ViewContext | None = None,
) -> None:
    """Write the identification of a dataset as an .rrd file, whole or not at all.

    Entities below the name of each recording: robot (moving at 50 Hz, with closed loops), current/JOINT (logged, at the
    log's rate; measured and modelled, at the fit's), error/JOINT with the deviation of the fitted errors,
    position/JOINT, phases, tool and loop_gap; with a context also steps/JOINT (the errors of earlier models),
    torque/JOINT (of effects) and robot/simulated (a simulated robot in outline). /summary and /parameters: the result
    as text. Every recording starts at time 0.
    truth: true values to compare with, by joint, parameter name or EFFECT:JOINT.PARAMETER.

    Raises BenchError for another suffix than .rrd, and for a result that is not of this dataset.
    """
    context = context or ViewContext()
    truth = truth if truth is not None else context.truth
    _check_suffix(path)
    run = _run(ViewedRun(result.robot, result, dataset, context), "")
    largest = _largest_error([run])
    views = blueprint(_scenes(run, largest), run.motors)
    with rrd_stream(path, _application([run]), f"{result.robot}, {result.method}", views) as stream:
        _send_text(stream, run, truth)
        _send(stream, run, largest)


def write_side_by_side(path: str | Path, viewed: Sequence[ViewedRun]) -> None:
    """Write several identifications as one .rrd file, recordings of the same name side by side.

    Entities are those of `write_rrd`, below the title of each identification. Raises BenchError for another suffix than
    .rrd, if there is nothing to show, and for robots whose motors differ.
    """
    _check_suffix(path)
    if not viewed:
        raise BenchError(f"{path}: nothing to show")
    runs = [
        _run(viewed_run, rr.new_entity_path([f"{k} {viewed_run.title}"]))
        for k, viewed_run in enumerate(viewed)
    ]
    for run in runs:
        if [motor.name for motor in run.motors] != [motor.name for motor in runs[0].motors]:
            names = f"{runs[0].viewed.result.robot} and {run.viewed.result.robot}"
            raise BenchError(f"{path}: {names} have other motors: they cannot stand beside each other")
    largest = _largest_error(runs)
    by_name: dict[str, list[Scene]] = {}
    for run in runs:
        for content, scene in zip(run.shown, _scenes(run, largest, run.viewed.title), strict=True):
            by_name.setdefault(PurePath(content.series.name).stem, []).append(scene)
    errors = [np.concatenate([error_where_moving(shown.series) for shown in run.shown]) for run in runs]
    reach = 1.05 * np.nanmax(np.abs(np.concatenate(errors)), axis=0, initial=1e-12)
    views = side_by_side(list(by_name.items()), runs[0].motors, reach)
    with rrd_stream(path, _application(runs), f"{len(runs)} identifications", views) as stream:
        for run in runs:
            _send_text(stream, run, run.viewed.context.truth)
            _send(stream, run, largest)


def entity_roots(names: Sequence[str]) -> Mapping[str, str]:
    """The entity of every recording: its file name, without the suffix unless two would be equal."""
    stems = Counter(PurePath(name).stem for name in names)
    return {
        name: rr.new_entity_path([PurePath(name).stem if stems[PurePath(name).stem] == 1 else name])
        for name in names
    }


def _check_suffix(path: str | Path) -> None:
    if Path(path).suffix.lower() != ".rrd":
        raise BenchError(
            f"{path}: a Rerun recording is an .rrd file; one for Foxglove or PlotJuggler an .mcap file"
        )


def _application(runs: Sequence[_Run]) -> str:
    """A name for the application that depends on what is shown, since the viewer keeps one layout per application."""
    parts = [
        f"{content.root} {bool(content.steps)} {content.has_torques} {content.reference_path is not None}"
        for run in runs
        for content in run.shown
    ]
    robot = re.sub(r"[^A-Za-z0-9]", "_", runs[0].viewed.result.robot)
    return f"parabench_{robot}_{zlib.crc32(chr(10).join(parts).encode()):08x}"


def _run(viewed: ViewedRun, prefix: str) -> _Run:
    geometry = read_geometry(viewed.dataset.robot)
    model = viewed.dataset.robot.mjcf_model()
    return _Run(
        viewed, prefix, model, _motors(viewed.result, geometry), _shown(viewed, prefix, model, geometry)
    )


def _shown(viewed: ViewedRun, prefix: str, model: mujoco.MjModel, geometry: Geometry) -> list[ShownContent]:
    result, dataset, context = viewed.result, viewed.dataset, viewed.context
    by_name = {recording.name: recording for recording in dataset.recordings}
    roots = entity_roots([series.name for series in result.recordings])
    deviation = error_std(result)
    shown = []
    for series in result.recordings:
        recording = by_name.get(series.name)
        if recording is None or recording.current.shape[1] != series.measured.shape[1]:
            raise BenchError(f"{dataset.folder}: has no recording {series.name!r} as the result does")
        motion = body_motion(model, geometry, recording, result.settings)
        poses = context.simulated.get(series.name)
        known = context.known.get(series.name) or _logged_reference(recording, dataset.robot.joints)
        shown.append(
            ShownContent(
                root=f"{prefix}{roots[series.name]}",
                recording=recording,
                series=series,
                motion=motion,
                deviation=deviation,
                payload=dataset.payloads[recording.payload] if recording.payload else None,
                steps=tuple(
                    (step.label, trace)
                    for step in context.steps
                    for trace in step.recordings
                    if trace.name == series.name
                ),
                label=context.label,
                torques=context.torques.get(series.name),
                known=known,
                reference_path=_reference_path(model, geometry, motion, known),
                simulated=None
                if poses is None
                else placed(model, geometry.robot.tool_site, poses.time, poses.poses),
            )
        )
    return shown


def _logged_reference(recording: Recording, joints: Sequence[str]) -> KnownTruth | None:
    """The reference positions, if the log has finite ones as reference.JOINT for every motor; else None."""
    columns = [recording.extra.get(f"{REFERENCE_COLUMN}{joint}") for joint in joints]
    references = [column for column in columns if column is not None]
    if len(references) < len(joints) or not np.isfinite(references).all():
        return None
    return KnownTruth(recording.time, reference=np.stack(references, axis=1))


def _reference_path(
    model: mujoco.MjModel, geometry: Geometry, motion: BodyMotion, known: KnownTruth | None
) -> np.ndarray | None:
    """The controller's reference for the tool (F, 3), m; None if it is unknown or out of the robot's reach."""
    if known is None or known.reference is None:
        return None
    wanted = np.stack([np.interp(motion.time, known.time, entry) for entry in known.reference.T], axis=1)
    try:
        return tool_path(model, geometry, motion.time, wanted)
    except BenchError:
        return None


def _motors(result: Identification, geometry: Geometry) -> list[Motor]:
    kinds = {joint.name: joint.kind for joint in geometry.joints}
    return [
        Motor(
            name=joint,
            entity=rr.escape_entity_path_part(joint),
            current_unit=drive_unit(result.drive_gains[joint].unit),
            position_unit=joint_units(kinds[joint] != "slide").position,
            effort_unit=joint_units(kinds[joint] != "slide").spelled_effort,
            gain=result.drive_gains[joint].value,
        )
        for joint in result.joints
    ]


def _largest_error(runs: Sequence[_Run]) -> float:
    """The error share at the upper end of the path's colour scale: percentile `TOP` over all recordings."""
    shares = np.concatenate([error_share(content.series) for run in runs for content in run.shown])
    known = shares[np.isfinite(shares)]
    return float(np.percentile(known, TOP)) if len(known) and known.any() else 1.0


def _scenes(run: _Run, largest: float, title: str | None = None) -> list[Scene]:
    """The scenes of all recordings, with the same camera."""
    low = np.min([content.motion.low for content in run.shown], axis=0)
    high = np.max([content.motion.high for content in run.shown], axis=0)
    eye, target = eye_of(low, high, run.model.vis.global_.azimuth, run.model.vis.global_.elevation)
    return [
        Scene(
            title=title or f"{PurePath(content.series.name).stem} ({USES[content.series.use]})",
            content=content,
            errors=tuple(
                percent(relative_error([content.series], j)) for j in range(content.series.measured.shape[1])
            ),
            path=_key(content, largest),
            eye=eye,
            target=target,
            low=float(low[2]),
            texts=run.prefix,
        )
        for content in run.shown
    ]


def _key(content: ShownContent, largest: float) -> str:
    """Key to the colours and outlines."""
    parts = [] if content.simulated is None else ["outlined: simulated"]
    if content.motion.tool_position is not None:
        parts.append(f"path: error from 0 (violet) to {percent(largest)} (yellow)")
    return ", ".join(parts)


def _send_text(stream: rr.RecordingStream, run: _Run, truth: Truth | None) -> None:
    above = f"{run.viewed.context.text.rstrip()}\n\n" if run.viewed.context.text else ""
    for entity, text in (
        (SUMMARY, above + summary_markdown(run.viewed.result, truth)),
        (PARAMETERS, parameters_markdown(run.viewed.result, truth)),
    ):
        stream.log(
            f"{run.prefix}{entity}", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True
        )


def _send(stream: rr.RecordingStream, run: _Run, largest: float) -> None:
    for content in run.shown:
        send_currents(stream, content, run.motors)
        send_steps(stream, content, run.motors)
        send_torques(stream, content, run.motors)
        send_tool(stream, content, run.motors)
        send_phases(stream, content, run.motors)
        send_robot(stream, content, run.model, largest)
        if content.payload is not None:
            send_payload(stream, content, content.payload)
