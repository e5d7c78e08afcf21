"""An identification as an MCAP file, which Foxglove and PlotJuggler open.

Every recording has these topics, of JSON messages with one object per joint; time is 0 at its first sample:
RECORDING/log (position and current as logged), RECORDING/currents (measured, modelled, error, at the rate of the fit),
RECORDING/joint_states (position, velocity, acceleration), RECORDING/torque/EFFECT, and RECORDING/torque/hidden of a
simulated machine. A message lacks values that are unknown, such as an error at standstill.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.basics.joint_units import drive_unit, joint_units
from bench.dataset.recording import Recording
from bench.document.numbers import error_where_moving
from bench.identification.result import CurrentSeries, Identification
from bench.model.geometry import read_geometry
from bench.viewer.recording import ViewedRun

SUFFIX = ".mcap"
HIDDEN = "hidden"  # the topic with the true torque; no effect has this name
ENCODING, SCHEMA_ENCODING = "json", "jsonschema"


@dataclass(frozen=True, eq=False)
class _Topic:
    """time (M,) s; values (M, n) by field name, and the unit of each field by joint."""

    name: str
    time: np.ndarray
    values: Mapping[str, np.ndarray]
    units: Mapping[str, Sequence[str]]


def need_mcap(path: Path) -> None:
    """Raise BenchError if the package mcap is not installed."""
    try:
        import mcap.writer  # noqa: F401, PLC0415 - an extra that may be absent
    except ModuleNotFoundError as error:
        raise BenchError(f"{path}: an MCAP file needs mcap: pip install 'parabench[mcap]'") from error


def write_mcap(path: Path, viewed: Sequence[ViewedRun]) -> None:
    """Write identifications as one file, whole or not at all; with several, their titles prefix the topics.

    Raises BenchError if mcap is not installed.
    """
    need_mcap(path)
    from mcap.writer import Writer  # noqa: PLC0415

    with atomic_path(path) as partial, partial.open("wb") as file:
        writer = Writer(file)
        writer.start(library="parabench")
        messages: list[tuple[np.ndarray, int, Sequence[bytes]]] = []
        for number, run in enumerate(viewed):
            prefix = f"/{_plain(f'{number} {run.title}')}" if len(viewed) > 1 else ""
            result = run.result
            writer.add_metadata(f"identification{prefix}", _metadata(result))
            for topic in _topics(run, prefix):
                schema = writer.register_schema(
                    topic.name.strip("/"), SCHEMA_ENCODING, _schema(topic, result.joints)
                )
                channel = writer.register_channel(topic.name, ENCODING, schema)
                messages.append(
                    (np.rint(1e9 * topic.time).astype(int), channel, _encoded(topic, result.joints))
                )
        for time, channel, data in _in_time(messages):
            writer.add_message(channel, log_time=time, data=data, publish_time=time)
        writer.finish()  # type: ignore[no-untyped-call]


def _topics(run: ViewedRun, prefix: str) -> Iterator[_Topic]:
    result, context = run.result, run.context
    by_name = {recording.name: recording for recording in run.dataset.recordings}
    kinds = {joint.name: joint.kind for joint in read_geometry(run.dataset.robot).joints}
    units_of = [joint_units(kinds[joint] != "slide") for joint in result.joints]
    currents = [drive_unit(result.drive_gains[joint].unit) for joint in result.joints]
    positions = [units.position for units in units_of]
    efforts = [units.effort for units in units_of]
    names = _names([series.name for series in result.recordings])
    for series, name in zip(result.recordings, names, strict=True):
        recording, root = by_name[series.name], f"{prefix}/{name}"
        start = recording.time[0]
        units = {"position": positions, "current": currents}
        values = {"position": recording.position, "current": recording.current}
        yield _Topic(f"{root}/log", recording.time - start, values, units)
        yield from _fitted(series, root, recording, currents, positions)
        torques = {effect: (series.time, torque) for effect, torque in series.by_effect.items()}
        known = context.known.get(series.name)
        if known is not None and known.torque is not None:
            torques[HIDDEN] = (known.time, known.torque)
        for effect, (time, torque) in torques.items():
            yield _Topic(f"{root}/torque/{effect}", time - start, {"torque": torque}, {"torque": efforts})


def _fitted(
    series: CurrentSeries, root: str, recording: Recording, currents: Sequence[str], positions: Sequence[str]
) -> Iterator[_Topic]:
    time = series.time - recording.time[0]
    values = {"measured": series.measured, "modelled": series.modelled, "error": error_where_moving(series)}
    yield _Topic(f"{root}/currents", time, values, dict.fromkeys(values, currents))
    motion = {"position": series.position, "velocity": series.velocity, "acceleration": series.acceleration}
    per = {"position": "", "velocity": "/s", "acceleration": "/s^2"}
    units = {name: [f"{unit}{per[name]}" for unit in positions] for name in motion}
    yield _Topic(f"{root}/joint_states", time, motion, units)


def _encoded(topic: _Topic, joints: Sequence[str]) -> list[bytes]:
    """The message of each row: the known fields of every joint."""
    fields = list(topic.values)
    rows = np.stack([topic.values[name] for name in fields], axis=2)  # (M, n, fields)
    known = np.isfinite(rows)
    return [
        json.dumps(
            {
                joint: {name: value for name, value, there in zip(fields, row, shown, strict=True) if there}
                for joint, row, shown in zip(joints, entry, present, strict=False)
            },
            separators=(",", ":"),
        ).encode()
        for entry, present in zip(rows.tolist(), known.tolist(), strict=True)
    ]


def _schema(topic: _Topic, joints: Sequence[str]) -> bytes:
    of_joint = {
        joint: {
            "type": "object",
            "properties": {
                name: {"type": "number", "description": topic.units[name][j]} for name in topic.values
            },
        }
        for j, joint in enumerate(joints)
    }
    return json.dumps({"type": "object", "properties": of_joint}).encode()


def _in_time(messages: Sequence[tuple[np.ndarray, int, Sequence[bytes]]]) -> Iterator[tuple[int, int, bytes]]:
    """The messages of all topics in the order of their times, which readers expect."""
    times = np.concatenate([time for time, _, _ in messages])
    which = np.repeat(np.arange(len(messages)), [len(time) for time, _, _ in messages])
    row = np.concatenate([np.arange(len(time)) for time, _, _ in messages])
    for k in np.argsort(times, kind="stable"):
        _, channel, data = messages[which[k]]
        yield int(times[k]), channel, data[row[k]]


def _metadata(result: Identification) -> dict[str, str]:
    gains = {
        f"drive gain {joint}": f"{gain.value!r} ± {gain.std!r} {gain.unit}"
        for joint, gain in result.drive_gains.items()
    }
    return {"robot": result.robot, "method": result.method, "effects": ", ".join(result.effects), **gains}


def _names(recordings: Sequence[str]) -> list[str]:
    """Each recording's part of a topic: its file name as a plain word, numbered if two would be equal."""
    taken: list[str] = []
    for name in recordings:
        stem = _plain(name.removesuffix(PurePath(name).suffix))
        alike = [stem, *(f"{stem}_{number}" for number in range(2, len(recordings) + 1))]
        taken.append(next(word for word in alike if word not in taken))
    return taken


def _plain(text: str) -> str:
    """The text with underscores for characters that do not belong in topic names."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", text).strip("_")
