"""A dataset: a robot, its payloads and the recordings of its movements, as a folder with dataset.toml."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from bench.errors import BenchError
from bench.files import write_text_atomically
from bench.joint_facts import joint_facts
from bench.payload import Payload, payload_fault
from bench.recording import Recording, Use
from bench.recording_checks import Check
from bench.recording_file import load_recording
from bench.robot import Robot, load_robot
from bench.toml_input import UserTable, read_toml

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


class DatasetSpec(UserTable):
    """What dataset.toml may hold."""

    robot: Annotated[str, Field(min_length=1)]
    effects: tuple[str, ...] = ()
    payloads: dict[str, PayloadSpec] = Field(default_factory=dict)
    recordings: Annotated[list[RecordingSpec], Field(min_length=1)]


@dataclass(frozen=True, eq=False)
class Dataset:
    """Everything that an identification reads.

    effect_files are the user's own effects, from the optional key `effects`.
    """

    folder: Path
    robot: Robot
    payloads: Mapping[str, Payload]
    recordings: tuple[Recording, ...]
    effect_files: tuple[Path, ...] = field(default=())


def load_dataset(folder: str | Path) -> Dataset:
    """Read and check the dataset in `folder` (or the dataset.toml itself).

    Errors: BenchError in one line that names the file and the key, or the file, the column and the row.
    """
    path = Path(folder)
    if path.is_dir():
        path = path / DATASET_FILE
    elif path.suffix != ".toml":
        raise BenchError(f"{path}: no such dataset folder")
    spec = read_toml(path, DatasetSpec)
    folder = path.parent
    robot = load_robot(spec.robot, relative_to=folder)
    payloads = {name: _payload(path, name, entry) for name, entry in spec.payloads.items()}
    _check_references(path, spec, robot)
    effect_files = tuple(folder / name for name in spec.effects)
    for name, file in zip(spec.effects, effect_files, strict=True):
        if not file.is_file():
            raise BenchError(f"{path}: effects: no such file {name!r}")
    joints = joint_facts(robot)
    recordings = tuple(
        load_recording(folder / entry.file, entry.file, entry.use, entry.payload, joints, entry.accept)
        for entry in spec.recordings
    )
    return Dataset(folder, robot, payloads, recordings, effect_files)


def _payload(path: Path, name: str, spec: PayloadSpec) -> Payload:
    payload = Payload(
        name,
        spec.mass,
        None if spec.center_of_mass is None else np.array(spec.center_of_mass),
        None if spec.inertia is None else np.array(spec.inertia),
    )
    if (fault := payload_fault(payload)) is not None:
        raise BenchError(f"{path}: payloads.{name}.{fault[0]}: {fault[1]}")
    return payload


def _check_references(path: Path, spec: DatasetSpec, robot: Robot) -> None:
    seen: set[str] = set()
    for i, entry in enumerate(spec.recordings):
        key = f"{path}: recordings[{i}]"
        if entry.file in seen:
            raise BenchError(f"{key}.file: {entry.file!r} is listed twice")
        seen.add(entry.file)
        if not (path.parent / entry.file).is_file():
            raise BenchError(f"{key}.file: no such file {entry.file!r}")
        if entry.payload is None:
            continue
        if entry.payload not in spec.payloads:
            known = ", ".join(sorted(spec.payloads)) or "none"
            raise BenchError(f"{key}.payload: {entry.payload!r} is not defined under [payloads] ({known})")
        if robot.tool_site is None:
            raise BenchError(f"{key}.payload: the robot {robot.name!r} has no [tool] site to fix it at")


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
) -> Path:
    """Write dataset.toml in `folder`, whole or not at all, and return its path.

    robot is a built-in name or a path (absolute, or relative to `folder`).
    """
    lines = [f"robot = {_text(robot)}"]
    if effects:
        lines.append(f"effects = [{', '.join(map(_text, effects))}]")
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
    path = Path(folder) / DATASET_FILE
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomically(path, "\n".join(lines) + "\n")
    return path


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False)  # a JSON string is a TOML basic string
