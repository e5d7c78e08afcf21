"""The file dataset.toml: its schema, how it is written, how a recording is added to it."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.basics.files.toml_input import UserTable, read_toml
from bench.basics.files.toml_output import toml_header, toml_line
from bench.dataset.controller import ControlLaw, ControllerSpec
from bench.dataset.names import DATASET_FILE, Check, Use
from bench.dataset.payload import Payload, payload_fault
from bench.dataset.recording_window import Spans
from bench.dataset.robot import Robot, load_robot

OF_THE_OLD = ("window", "exclude")  # stretches of the replaced log do not apply to the new one


@dataclass(frozen=True)
class RecordingEntry:
    """One [[recordings]] table to write: file name relative to the folder, use, payload, accepted checks."""

    file: str
    use: Use
    payload: str | None = None
    accept: tuple[Check, ...] = ()


def payload_keys(payload: Payload) -> dict[str, float | list[float]]:
    """The given values of a payload, under the keys of its table."""
    keys: dict[str, float | list[float]] = {} if payload.mass is None else {"mass": float(payload.mass)}
    for key, values in (("center_of_mass", payload.center_of_mass), ("inertia", payload.inertia)):
        if values is not None:
            keys[key] = np.asarray(values, dtype=np.float64).tolist()
    return keys


def edited(text: str, entries: Sequence[RecordingEntry], payloads: Sequence[Payload]) -> str:
    """The dataset.toml `text` with the given values for recordings and payloads that it already lists.

    A recording keeps its place in the list and loses its windows. Payload values that are not given stay as they are.
    """
    if not (entries or payloads):
        return text
    import tomlkit  # noqa: PLC0415 - slow to import, needed only to change a file

    document: Any = tomlkit.parse(text)
    tables = {table["file"]: table for table in document["recordings"]}
    for entry in entries:
        _set(tables[entry.file], entry)
    for payload in payloads:
        document["payloads"][payload.name].update(payload_keys(payload))
    return str(tomlkit.dumps(document))


def _set(table: Any, entry: RecordingEntry) -> None:
    given = {"use": entry.use, "payload": entry.payload, "accept": list(entry.accept) or None}
    for key, value in {**given, **dict.fromkeys(OF_THE_OLD)}.items():
        if value is not None:
            table[key] = value
        elif key in table:
            del table[key]


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
    """The keys of dataset.toml."""

    robot: Annotated[str, Field(min_length=1)]
    effects: tuple[str, ...] = ()
    payloads: dict[str, PayloadSpec] = Field(default_factory=dict)
    recordings: Annotated[list[RecordingSpec], Field(min_length=1)]
    controller: ControllerSpec | None = None


def payload_of(path: Path, name: str, spec: PayloadSpec) -> Payload:
    """The payload of a [payloads.NAME] table in the file `path`; BenchError if no rigid body has these values."""
    center, inertia = (None if v is None else np.array(v) for v in (spec.center_of_mass, spec.inertia))
    payload = Payload(name, spec.mass, center, inertia)
    if (fault := payload_fault(payload)) is not None:
        raise BenchError(f"{path}: payloads.{name}.{fault[0]}: {fault[1]}")
    return payload


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

    robot is a built-in name or a path (absolute, or relative to `folder`). joints: of the controller's gains.
    """
    lines = [toml_line("robot", robot)]
    if effects:
        lines.append(toml_line("effects", list(effects)))
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
        lines += ["", toml_header("payloads", payload.name)]
        lines += [toml_line(key, value) for key, value in payload_keys(payload).items()]
    for entry in recordings:
        lines += ["", "[[recordings]]", toml_line("file", entry.file), toml_line("use", entry.use)]
        if entry.payload is not None:
            lines.append(toml_line("payload", entry.payload))
        if entry.accept:
            lines.append(toml_line("accept", list(entry.accept)))
    return lines


def extended_toml(
    folder: Path,
    reference: str,
    robot: Robot,
    entries: Sequence[RecordingEntry],
    payloads: Sequence[Payload] = (),
    *,
    replace: bool = False,
) -> str:
    """The text of `folder`'s dataset.toml with recordings added and comments kept; a new one if there is none.

    A payload may be given again with the same values. replace: those of the same name are replaced.

    Errors: BenchError when the dataset belongs to another robot, already lists the recording, lacks the payload, or
    has a different payload of that name.
    """
    path = folder / DATASET_FILE
    if path.exists():
        spec = read_toml(path, DatasetSpec)
        text, defined, listed = path.read_text(encoding="utf-8-sig"), spec.payloads, spec.recordings
        if (other := load_robot(spec.robot, relative_to=folder)).folder != robot.folder:
            raise BenchError(f"{path}: robot: is {other.name!r} in {other.folder}, not {robot.name!r}")
    else:
        text, defined, listed = toml_line("robot", reference) + "\n", {}, []
    known = {recording.file for recording in listed}
    for entry in entries:
        if not (replace and entry.file in known):
            _check_free(folder / entry.file, listed=entry.file in known)
        if entry.payload is None:
            continue
        if robot.tool_site is None:
            raise BenchError(f"payload {entry.payload!r}: the robot {robot.name!r} has no [tool] site")
        if entry.payload not in {*defined, *(payload.name for payload in payloads)}:
            raise BenchError(f"{path}: payloads: {entry.payload!r} is not defined; give its mass")
    changed = [payload for payload in payloads if _differs(payload, defined.get(payload.name))]
    if changed and not replace:
        differing = _differing(defined[changed[0].name], changed[0])
        raise BenchError(
            f"{path}: payloads.{changed[0].name}: is already defined{differing}; "
            f"give its name alone, another name for another payload, or --replace to change it"
        )
    text = edited(text, [entry for entry in entries if entry.file in known], changed)
    new = [entry for entry in entries if entry.file not in known]
    tables = toml_tables(new, [payload for payload in payloads if payload.name not in defined])
    text = "\n".join([text.rstrip("\n"), *tables]) + "\n"
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BenchError(f"{path}: recordings: write them as [[recordings]] tables to add one") from error
    return text


def _check_free(path: Path, *, listed: bool) -> None:
    """Raises BenchError if a recording would overwrite a file that it does not replace."""
    unlisted = "" if listed else f", and {DATASET_FILE} does not list it"
    cure = "--replace to replace it by this log" if listed else "delete the file"
    if listed or path.exists():
        raise BenchError(
            f"{path}: exists already{unlisted}; choose another name for the recording, or {cure}"
        )


def _differs(payload: Payload, spec: PayloadSpec | None) -> bool:
    """Whether a given value is another than in dataset.toml. Raises BenchError if no body has these values."""
    if (fault := payload_fault(payload)) is not None:
        raise BenchError(f"payload {payload.name!r}: {fault[0]} {fault[1]}")
    known = {} if spec is None else spec.model_dump()
    return any(known.get(key, value) != value for key, value in payload_keys(payload).items())


def _differing(spec: PayloadSpec, payload: Payload) -> str:
    """How a payload differs from its definition, in words."""
    if payload.mass is None or spec.mass == payload.mass:
        return " with other numbers"
    before = "no mass" if spec.mass is None else f"{spec.mass:g} kg"
    return f" with {before}, not {payload.mass:g} kg"


def _controller_table(controller: ControlLaw, joints: Sequence[str]) -> list[str]:
    lines = [
        toml_line(key, dict(zip(joints, getattr(controller, key).tolist(), strict=True)))
        for key in ("kp", "kv", "ka")
    ]
    return ["[controller]", *lines, toml_line("velocity_delay", controller.velocity_delay)]
