"""A dataset: a robot, its payloads and the recordings of its movements, as a folder with dataset.toml."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import read_toml
from bench.basics.program import typed
from bench.basics.shell_word import quoted
from bench.dataset.controller import ControlLaw, controller_of, references
from bench.dataset.dataset_toml import DatasetSpec, payload_of
from bench.dataset.dataset_toml import RecordingEntry as RecordingEntry
from bench.dataset.dataset_toml import write_dataset_toml as write_dataset_toml
from bench.dataset.joint_facts import joint_facts
from bench.dataset.names import DATASET_FILE, LOGS
from bench.dataset.payload import Payload
from bench.dataset.recording import Recording
from bench.dataset.recording_window import Window
from bench.dataset.robot import Robot, load_robot

HEAVY = 2.0  # times the mass of the robot's bodies: hardly any robot carries that much
LIGHT = 5.0  # kg: a lighter payload is never doubted, whatever mass the MJCF gives the robot


@dataclass(frozen=True)
class HeavyPayload:
    """A payload whose mass is doubted. mass: as declared, kg; robot_mass: of the robot's bodies in its MJCF, kg."""

    name: str
    mass: float
    robot_mass: float

    @property
    def if_grams(self) -> float:
        """The mass in kg if the declared number was meant in grams."""
        return self.mass / 1e3

    @property
    def words(self) -> str:
        """The question for the user."""
        return (
            f"the payload {self.name} of {self.mass:g} kg is far heavier than the robot ({self.robot_mass:.3g} kg in "
            f"its MJCF): is that in grams, {self.if_grams:g} kg?"
        )


def heavy_payload(payload: Payload, robot: Robot) -> HeavyPayload | None:
    """The payload if its mass is doubted; None if the mass is plausible or unknown."""
    if payload.mass is None or payload.mass <= LIGHT:
        return None
    robot_mass = float(robot.mjcf_model().body_mass.sum())
    return HeavyPayload(payload.name, payload.mass, robot_mass) if payload.mass > HEAVY * robot_mass else None


def doubted(
    payloads: Iterable[Payload], loads: Iterable[tuple[str | None, Iterable[str]]], robot: Robot
) -> tuple[HeavyPayload, ...]:
    """The payloads whose mass is doubted. loads: for each log, its payload and the checks that it accepts. A payload
    is not doubted if one of its logs accepts "mass".
    """
    meant = {payload for payload, accepted in loads if "mass" in accepted}
    heavy = [heavy_payload(payload, robot) for payload in payloads if payload.name not in meant]
    return tuple(payload for payload in heavy if payload is not None)


@dataclass(frozen=True, eq=False, repr=False)
class Dataset:
    """Everything that an identification reads.

    effect_files are the user's effects, from the optional key `effects`. controller: the control law of the joints,
    if the dataset has one. doubted: payloads so heavy that the user is asked about their mass.
    """

    folder: Path
    robot: Robot
    payloads: Mapping[str, Payload]
    recordings: tuple[Recording, ...]
    effect_files: tuple[Path, ...] = field(default=())
    controller: ControlLaw | None = None
    doubted: tuple[HeavyPayload, ...] = ()

    @property
    def weighed(self) -> list[str]:
        """Names of the payloads whose mass is known."""
        return [name for name, payload in self.payloads.items() if payload.mass is not None]

    def __repr__(self) -> str:
        names = ", ".join(f"{recording.name} ({recording.use})" for recording in self.recordings)
        return f"<dataset {self.folder.name} of {self.robot.name}: {names}>"


def load_dataset(folder: str | Path) -> Dataset:
    """Read and check the dataset in `folder` (or the dataset.toml itself).

    Errors: BenchError in one line that names the file and the key, or the file, the column and the row.
    """
    # pyarrow takes 25 MB, and recordings that are already in memory do not need it
    from bench.basics.files.table import release_tables  # noqa: PLC0415
    from bench.dataset.recording_file import load_recordings  # noqa: PLC0415

    path = Path(folder)
    if path.is_dir():
        path = path / DATASET_FILE
        if not path.exists():
            raise BenchError(f"{folder}: is not a dataset: it has no {DATASET_FILE}")
    elif path.suffix != ".toml":
        refuse_log(path)
        if path.is_file():
            raise BenchError(f"{path}: is a file: give its folder, the one with the {DATASET_FILE}")
        raise BenchError(f"{path}: no such dataset folder")
    spec = read_toml(path, DatasetSpec)
    folder = path.parent
    robot = load_robot(spec.robot, relative_to=folder)
    payloads = {name: payload_of(path, name, entry) for name, entry in spec.payloads.items()}
    _check_references(path, spec, robot)
    effect_files = tuple(folder / name for name in spec.effects)
    for name, file in zip(spec.effects, effect_files, strict=True):
        if not file.is_file():
            raise BenchError(f"{path}: effects: no such file {name!r}")
    joints = joint_facts(robot)
    recordings = [
        recording
        for entry in spec.recordings
        for recording in load_recordings(
            folder / entry.file,
            entry.file,
            entry.use,
            entry.payload,
            joints,
            entry.accept,
            Window(entry.window, entry.exclude),
        )
    ]
    release_tables()
    _refuse_copies(path, recordings)
    controller = None
    if spec.controller is not None:
        controller = controller_of(path, spec.controller, robot.joints)
        for recording in recordings:
            references(recording, robot.joints)  # raises if one is missing
    loads = [(entry.payload, entry.accept) for entry in spec.recordings]
    heavy = doubted(payloads.values(), loads, robot)
    return Dataset(folder, robot, payloads, tuple(recordings), effect_files, controller, heavy)


def refuse_log(path: Path) -> None:
    """Raise BenchError, with the import command, if `path` is a log that belongs to no dataset."""
    if path.suffix.lower() in LOGS and path.is_file() and not (path.parent / DATASET_FILE).exists():
        next_step = f"`{typed()} import {quoted(path)} --robot ROBOT` makes one of it"
        raise BenchError(f"{path}: is a log, not yet a dataset: {next_step}")


def _refuse_copies(path: Path, recordings: Sequence[Recording]) -> None:
    """Raise BenchError for two equal logs: they would shrink the standard errors, or validate each other."""
    for first, second in combinations(recordings, 2):
        if first.name != second.name and all(
            np.array_equal(samples, others, equal_nan=True)
            for samples, others in ((first.position, second.position), (first.current, second.current))
        ):
            raise BenchError(
                f"{path}: recordings: {second.name!r} holds the same samples as {first.name!r}: remove one of the two"
            )


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
