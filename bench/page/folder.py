"""A result folder: everything needed to write its page again without new computation.

report.json has the command, the dataset and the statements of a diagnosis; next to it are the models, their currents
(series.parquet), and the data of a diagnosis's workbench (workbench.json). It is written after the other files and has
their digests.
"""

import hashlib
import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from pydantic import TypeAdapter, ValidationError

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically, write_text_atomically
from bench.basics.files.toml_input import first_mistake
from bench.basics.plain_data import finite
from bench.basics.versions import Versions, versions
from bench.dataset.dataset import Dataset, load_dataset
from bench.dataset.names import DATASET_FILE, RUN_FILE
from bench.diagnosis.discovery.law_files import law_effects
from bench.diagnosis.result import (
    Diagnosis,
    Differing,
    Discovered,
    EffectVerdict,
    LadderStep,
    ProbableSet,
    Superfluous,
    Unexplained,
    Unfinished,
    WithoutLog,
)
from bench.diagnosis.split import with_held_out_parts
from bench.identification.model_file import load_model, read_identification, save_model
from bench.identification.problem import Problem, problem_of
from bench.identification.result import CurrentSeries, Identification
from bench.page.section_run import CommandRun
from bench.page.series_file import read_series, write_series
from bench.page.workbench.page_data import VERSION as WORKBENCH_VERSION

SIZE = 16  # bytes
MODEL_FILE, AFTER_FILE, BEFORE_FILE = "model.json", "model_after.json", "model_before.json"
SERIES_FILE, WORKBENCH_FILE = "series.parquet", "workbench.json"
FORMAT = 2
INFINITE = frozenset(
    {"error_before", "error_after", "evidence", "std"}
)  # null in these fields means infinity, which JSON lacks


def dataset_digest(dataset: Dataset, effect_files: Sequence[Path] = ()) -> str:
    """Digest of dataset.toml, the recordings, the robot's description and mechanism, and the files with effects.

    The mechanism is the model that MuJoCo compiles, so that files included by the MJCF count too. effect_files: in
    addition to the dataset's.
    """
    robot = dataset.robot
    names = dict.fromkeys([DATASET_FILE, *(recording.log for recording in dataset.recordings)])
    files = [*(dataset.folder / name for name in names), robot.folder / "robot.toml"]
    files += [*dataset.effect_files, *effect_files]
    digest = hashlib.blake2b(digest_size=SIZE)
    for path in files:
        digest.update(bytes.fromhex(file_digest(path)))
    model = robot.mjcf_model()
    mechanism = np.zeros(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, mechanism)
    digest.update(mechanism.tobytes())
    return digest.hexdigest()


def file_digest(path: Path) -> str:
    """Digest of a file's bytes. Raises BenchError if it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=SIZE)).hexdigest()
    except OSError as error:
        raise BenchError(f"{path}: {error.strerror or error}") from None


@dataclass(frozen=True)
class _Step:
    effects: tuple[str, ...]
    identify: float | None
    validate: float | None


@dataclass(frozen=True, kw_only=True)
class _DiagnosisFile:
    """A diagnosis without its models. between: steps of its ladder, other than first and last, with saved currents."""

    ladder: tuple[_Step, ...]
    held_out: float
    missing: tuple[str, ...]
    ranking: tuple[EffectVerdict, ...]
    unexplained: Unexplained
    differs: tuple[Differing, ...] = ()
    sets: tuple[ProbableSet, ...] = ()
    without_logs: tuple[WithoutLog, ...] = ()
    something_else: float = 0.0
    superfluous: tuple[Superfluous, ...] = ()
    unfinished: tuple[Unfinished, ...] = ()
    discovered: tuple[Discovered, ...] = ()
    between: tuple[int, ...]


SAME = tuple(entry.name for entry in fields(_DiagnosisFile) if entry.name not in ("ladder", "between"))
"""Fields that a `Diagnosis` has under the same names."""


@dataclass(frozen=True)
class _RunFile:
    """report.json; files of earlier versions lack the last fields."""

    run: CommandRun
    dataset: str
    model: str
    diagnosis: _DiagnosisFile | None = None
    digest: str | None = None
    versions: Versions | None = None
    workbench: int | None = None
    files: Mapping[str, str] = field(default_factory=dict)


_READER = TypeAdapter(_RunFile)
_WRITER = TypeAdapter(Any)


@dataclass(frozen=True)
class SavedRun:
    """A result, computed in this process or read from its folder.

    model: name of the applied model, "" if it was fitted. workbench: data for a diagnosis's page, None if they have to
    be computed. by: the versions that computed the result. said: why something in the folder was computed anew, in one
    line; "" if nothing was.
    """

    run: CommandRun
    dataset: Dataset
    after: Identification
    diagnosis: Diagnosis | None
    model: str
    workbench: dict[str, Any] | None = None
    by: Versions = field(default_factory=versions)
    said: str = ""

    @property
    def with_held_out(self) -> Dataset:
        """The dataset with the recordings of the currents; for a diagnosis with held-out parts, as it judged them."""
        return self.dataset if self.diagnosis is None else with_held_out_parts(self.dataset)[0]

    @cached_property
    def problem(self) -> Problem:
        """The problem of the command, with discovered laws in its catalogue."""
        laws = () if self.diagnosis is None else self.diagnosis.discovered
        return _problem(self.dataset, self.run, laws)

    @property
    def effect_files(self) -> list[Path]:
        """Files of user-defined effects that the command named, in addition to the dataset's."""
        return [Path(file) for file in self.run.effect_files]


def save_run(folder: Path, kept: SavedRun) -> None:
    """Write report.json and the files that belong to it, each whole or not at all."""
    dataset, diagnosis = kept.dataset, kept.diagnosis
    joints = dataset.robot.joints
    content: dict[str, Any] = {
        "format": FORMAT,
        "run": asdict(kept.run),
        "dataset": os.path.relpath(dataset.folder, folder),
        "model": kept.model,
        "digest": dataset_digest(dataset, kept.effect_files),
        "versions": asdict(kept.by),
        "workbench": WORKBENCH_VERSION,
    }
    written = [MODEL_FILE if diagnosis is None else AFTER_FILE, SERIES_FILE]
    save_model(kept.after, folder / written[0], dataset.folder)
    models = [kept.after.recordings]
    if diagnosis is not None:
        save_model(diagnosis.before, folder / BEFORE_FILE, dataset.folder)
        written.append(BEFORE_FILE)
        ladder = diagnosis.ladder
        kept_diagnosis = _DiagnosisFile(
            ladder=tuple(_Step(step.effects, step.identify, step.validate) for step in ladder),
            between=tuple(i for i in range(1, len(ladder) - 1) if ladder[i].recordings),
            **{name: getattr(diagnosis, name) for name in SAME},
        )
        content["diagnosis"] = _WRITER.dump_python(kept_diagnosis)
        between = [ladder[i].recordings for i in kept_diagnosis.between]
        bare = [tuple(replace(entry, by_effect={}) for entry in series) for series in between]
        models += [diagnosis.before.recordings, *bare]
    write_series(folder / SERIES_FILE, models, joints)
    content["files"] = {name: file_digest(folder / name) for name in written}
    write_json_atomically(folder / RUN_FILE, finite(content))
    if kept.workbench is not None:
        save_workbench(folder, kept)


def save_workbench(folder: Path, kept: SavedRun) -> None:
    """Write the data of a page's workbench into the folder of a saved run."""
    write_text_atomically(folder / WORKBENCH_FILE, json.dumps(finite(kept.workbench), allow_nan=False))
    content = json.loads((folder / RUN_FILE).read_text(encoding="utf-8"))
    content["files"][WORKBENCH_FILE] = file_digest(folder / WORKBENCH_FILE)
    write_json_atomically(folder / RUN_FILE, content)


def read_run(folder: Path) -> SavedRun:
    """Read a result folder; nothing is fitted or searched.

    If the dataset, robot or effects have changed since, the models are applied to them anew. Raises BenchError naming
    what is missing or damaged, the dataset included.
    """
    path = folder / RUN_FILE
    try:
        written = _READER.validate_python(_with_infinities(read_json(path)))
    except ValidationError as error:
        raise BenchError(f"{path}: damaged: {first_mistake(error)}") from None
    run, diagnosed, data = written.run, written.diagnosis, folder / written.dataset
    if not data.is_dir():
        raise BenchError(f"{path}: its dataset is not there any more: {data}")
    dataset = load_dataset(data)
    for name, expected in written.files.items():
        if file_digest(folder / name) != expected:
            said = f"not what was written beside {RUN_FILE}: damaged, or changed since"
            raise BenchError(f"{folder / name}: {said}")
    said = ""
    if written.digest is None:
        said = "written by an earlier version, which kept less: worked out anew"
    elif written.digest != dataset_digest(dataset, [Path(file) for file in run.effect_files]):
        said = "its dataset, robot or effects have changed since: its models are applied to them anew"
    with_held_out = with_held_out_parts(dataset)[0] if diagnosed is not None else dataset
    names = [MODEL_FILE] if diagnosed is None else [AFTER_FILE, BEFORE_FILE]
    paths = [folder / name for name in names]
    if said:
        laws = () if diagnosed is None else diagnosed.discovered
        problem = replace(_problem(dataset, run, laws), dataset=with_held_out)
        models = [read_identification(file, problem) for file in paths]
        diagnosis = None if diagnosed is None else _diagnosis(diagnosed, models, {})
        return SavedRun(run, dataset, models[0], diagnosis, written.model, said=f"{folder}: {said}")
    between = () if diagnosed is None else diagnosed.between
    saved = [load_model(file) for file in paths]
    effects = [tuple(model.model.effect_parameters) for model in saved]
    series = read_series(folder / SERIES_FILE, with_held_out, [*effects, *(() for _ in between)])
    models = [model.applied_to(with_held_out, its) for model, its in zip(saved, series, strict=False)]
    rungs = dict(zip(between, series[len(paths) :], strict=True))
    diagnosis = None if diagnosed is None else _diagnosis(diagnosed, models, rungs)
    workbench = None
    if WORKBENCH_FILE in written.files:
        if written.workbench == WORKBENCH_VERSION:
            workbench = _read_object(folder / WORKBENCH_FILE)
        else:
            said = f"{folder}: written by another version: the workbench is worked out anew"
    by = written.versions or versions()
    return SavedRun(run, dataset, models[0], diagnosis, written.model, workbench, by, said)


def _problem(dataset: Dataset, run: CommandRun, laws: Sequence[Discovered]) -> Problem:
    """The problem of a command; laws: added to its catalogue."""
    asked = problem_of(dataset, run.effects, effect_files=run.effect_files)
    return replace(asked, catalogue={**asked.catalogue, **law_effects(laws)})


def read_json(path: Path) -> dict[str, Any]:
    """The JSON object in a file of this format. Raises BenchError naming the file."""
    content = _read_object(path)
    if content.get("format") != FORMAT:
        raise BenchError(f"{path}: not a file that this version of bench wrote")
    return content


def _read_object(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchError(f"{path}: {error.strerror or error}") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: not a JSON file ({error})") from None
    if not isinstance(content, dict):
        raise BenchError(f"{path}: not a file that this version of bench wrote")
    return content


def _diagnosis(
    kept: _DiagnosisFile,
    models: Sequence[Identification],
    between: Mapping[int, tuple[CurrentSeries, ...]],
) -> Diagnosis:
    """models: after, before. between: currents of further steps of the ladder, by index."""
    after, before = models
    series = {len(kept.ladder) - 1: after.recordings, 0: before.recordings, **between}
    ladder = tuple(
        LadderStep(step.effects, step.identify, step.validate, series.get(i, ()))
        for i, step in enumerate(kept.ladder)
    )
    same = {name: getattr(kept, name) for name in SAME}
    return Diagnosis(after.robot, ladder=ladder, before=before, after=after, **same)


def _with_infinities(value: Any) -> Any:
    """Plain data from JSON, with infinity for null in the fields of `INFINITE`."""
    if isinstance(value, dict):
        return {
            name: math.inf if each is None and name in INFINITE else _with_infinities(each)
            for name, each in value.items()
        }
    return [_with_infinities(each) for each in value] if isinstance(value, list | tuple) else value
