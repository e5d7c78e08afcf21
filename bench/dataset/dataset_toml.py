"""The file dataset.toml: what it may hold, how it is written, how a recording is added to it."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from bench.basics.errors import BenchError
from bench.dataset.controller import ControlLaw, ControllerSpec
from bench.dataset.payload import Payload, payload_fault
from bench.dataset.recording import Use
from bench.dataset.recording_checks import Check
from bench.dataset.recording_window import Spans
from bench.dataset.robot import Robot, load_robot
from bench.files.atomic import write_text_atomically
from bench.files.toml_input import UserTable, read_toml

DATASET_FILE = "dataset.toml"
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]


class PayloadSpec(UserTable):
    """[payloads.NAME] of dataset.toml."""

    mass: Number | None = None
    center_of_mass: Annotated[list[Number], Field(min_length=3, max_length=3)] | None = None
    inertia: Annotated[list[Number], Field(min_length=6, max_length=6)] | None = None


class RecordingSpec(UserTable):
    """[[recordings]] of dataset.toml."""

    file: Annotated[str, Field(min_length=1)]
    use: Use
    payload: str | None = None
    accept: tuple[Check, ...] = ()
    window: Spans = ()
    exclude: Spans = ()


class DatasetSpec(UserTable):
    """What dataset.toml may hold."""

    robot: Annotated[str, Field(min_length=1)]
    effects: tuple[str, ...] = ()
    payloads: dict[str, PayloadSpec] = Field(default_factory=dict)
    recordings: Annotated[list[RecordingSpec], Field(min_length=1)]
    controller: ControllerSpec | None = None


def payload_of(path: Path, name: str, spec: PayloadSpec) -> Payload:
    """The payload of a [payloads.NAME] table in the file `path`; BenchError where it cannot exist."""
    payload = Payload(
        name,
        spec.mass,
        None if spec.center_of_mass is None else np.array(spec.center_of_mass),
        None if spec.inertia is None else np.array(spec.inertia),
    )
    if (fault := payload_fault(payload)) is not None:
        raise BenchError(f"{path}: payloads.{name}.{fault[0]}: {fault[1]}")
    return payload


@dataclass(frozen=True)
class RecordingEntry:
    """One [[recordings]] table to write: file name relative to the folder, use, payload, accepted checks."""

    file: str
    use: Use
    payload: str | None = None
    accept: tuple[Check, ...] = ()


def write_dataset_toml(
    folder: str | Path,
    robot: str,
    recordings: Sequence[RecordingEntry],
    payloads: Sequence[Payload] = (),
    effects: Sequence[str] = (),
    controller: ControlLaw | None = None,
    joints: Sequence[str] = (),
) -> Path:
    """Write dataset.toml in `folder`, whole or not at all, and return its path.

    robot is a built-in name or a path (absolute, or relative to `folder`). joints: of the controller's law.
    """
    lines = [f"robot = {_text(robot)}"]
    if effects:
        lines.append(f"effects = [{', '.join(map(_text, effects))}]")
    if controller is not None:
        lines += ["", *_controller_table(controller, joints)]
    path = Path(folder) / DATASET_FILE
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomically(path, "\n".join([*lines, *toml_tables(recordings, payloads)]) + "\n")
    return path


def toml_tables(recordings: Sequence[RecordingEntry], payloads: Sequence[Payload]) -> list[str]:
    """The lines of [payloads.NAME] and [[recordings]] tables, each after an empty line."""
    lines: list[str] = []
    for payload in payloads:
        lines += ["", f"[payloads.{_key(payload.name)}]"]
        if payload.mass is not None:
            lines.append(f"mass = {float(payload.mass)!r}")
        for key, values in (("center_of_mass", payload.center_of_mass), ("inertia", payload.inertia)):
            if values is not None:
                lines.append(f"{key} = {np.asarray(values, dtype=np.float64).tolist()!r}")
    for entry in recordings:
        lines += ["", "[[recordings]]", f"file = {_text(entry.file)}", f"use = {_text(entry.use)}"]
        if entry.payload is not None:
            lines.append(f"payload = {_text(entry.payload)}")
        if entry.accept:
            lines.append(f"accept = [{', '.join(map(_text, entry.accept))}]")
    return lines


def extended_toml(
    folder: Path,
    reference: str,
    robot: Robot,
    entries: Sequence[RecordingEntry],
    payloads: Sequence[Payload] = (),
) -> str:
    """The dataset.toml of `folder` with recordings added, comments and all; a new one where there is none.

    Errors: BenchError when the dataset is of another robot, lists the recording, or lacks the payload.
    """
    path = folder / DATASET_FILE
    if path.exists():
        spec = read_toml(path, DatasetSpec)
        text, defined, listed = path.read_text(encoding="utf-8-sig"), spec.payloads, spec.recordings
        if (other := load_robot(spec.robot, relative_to=folder)).folder != robot.folder:
            raise BenchError(f"{path}: robot: is {other.name!r} in {other.folder}, not {robot.name!r}")
    else:
        text, defined, listed = f"robot = {_text(reference)}\n", {}, []
    for entry in entries:
        known = entry.file in [recording.file for recording in listed]
        if known or (folder / entry.file).exists():
            also = f" and edit {path}" if known else ""
            raise BenchError(
                f"{folder / entry.file}: exists already; choose another name for the recording, "
                f"or delete the file{also}"
            )
        if entry.payload is None:
            continue
        if robot.tool_site is None:
            raise BenchError(f"payload {entry.payload!r}: the robot {robot.name!r} has no [tool] site")
        if entry.payload not in {*defined, *(payload.name for payload in payloads)}:
            raise BenchError(f"{path}: payloads: {entry.payload!r} is not defined; give its mass")
    for payload in payloads:
        if (fault := payload_fault(payload)) is not None:
            raise BenchError(f"payload {payload.name!r}: {fault[0]} {fault[1]}")
        if payload.name in defined:
            raise BenchError(
                f"{path}: payloads.{payload.name}: is defined already; give its name alone, or edit {path}"
            )
    text = text.rstrip("\n") + "\n" + "\n".join(toml_tables(entries, payloads)) + "\n"
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BenchError(f"{path}: recordings: write them as [[recordings]] tables to add one") from error
    return text


def _controller_table(controller: ControlLaw, joints: Sequence[str]) -> list[str]:
    lines = ["[controller]"]
    for key in ("kp", "kv", "ka"):
        pairs = zip(joints, getattr(controller, key).tolist(), strict=True)
        lines.append(f"{key} = {{ {', '.join(f'{_key(joint)} = {value!r}' for joint, value in pairs)} }}")
    return [*lines, f"velocity_delay = {controller.velocity_delay!r}"]


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False)  # a JSON string is a TOML basic string
