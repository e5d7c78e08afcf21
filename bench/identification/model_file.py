"""Save an identified model as JSON, read it back, and apply it to recordings."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.basics.plain_data import finite
from bench.basics.threads import on_one_thread
from bench.basics.versions import versions
from bench.dataset.dataset import Dataset
from bench.dataset.robot import refuse_other_locks
from bench.effects import Effect, EffectInstance
from bench.effects.user_file import load_effects
from bench.identification.by_recording import without_values_by_log
from bench.identification.finding import Finding
from bench.identification.finding_words import note
from bench.identification.findings import locked_findings
from bench.identification.frame import html_table
from bench.identification.layout import payload_columns, payload_parameter_names
from bench.identification.model_json import FORMAT, from_json, to_json
from bench.identification.nonlinear import present_model
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import Problem
from bench.identification.result import (
    CurrentSeries,
    DriveGain,
    ErrorSummary,
    Identification,
    ModelledRecording,
    error_summary,
)
from bench.identification.solution import Solution
from bench.identification.summary import ROBOT, modelled_series
from bench.signals.settings import FilterSettings

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False)
class SavedModel:
    """A model file: its answer, without currents, and the source of the data.

    dataset: the folder that it was identified from, if the file has it. recordings: those of it that were fitted or
    judged. effect_files: Python files with the user's effects in the model.
    """

    path: Path
    model: Identification
    dataset: Path | None = None
    recordings: tuple[ModelledRecording, ...] = ()
    effect_files: tuple[Path, ...] = ()

    def __repr__(self) -> str:
        return f"<{self.path.name}: {repr(self.model)[1:-1]}>"

    def _repr_html_(self) -> str:
        return html_table(repr(self)[1:-1], self.model.rows())

    @property
    def fitted(self) -> tuple[str, ...]:
        """Names of the fitted recordings, each with a value of some effects."""
        return tuple(recording.name for recording in self.recordings if recording.use == "identify")

    @property
    def drive_gains(self) -> Mapping[str, DriveGain]:
        """Drive gains by joint."""
        return self.model.drive_gains

    @property
    def effects(self) -> tuple[str, ...]:
        """The names of the effects that the model has."""
        return self.model.effects

    @property
    def error(self) -> ErrorSummary:
        """Relative errors by use, motor and recording, at identification."""
        return self.model.error

    def to_dataframe(self) -> pd.DataFrame:
        """Gains, parameters and effect parameters as of the result itself. Needs pandas."""
        return self.model.to_dataframe()

    @property
    def settings(self) -> FilterSettings:
        """The filters of its fit."""
        return self.model.settings

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the base and payload parameters by name."""
        return {parameter.name: parameter.value for parameter in self.model.parameters}

    def applied_to(self, dataset: Dataset, series: Sequence[CurrentSeries]) -> Identification:
        """The answer with its modelled currents for a dataset's recordings."""
        return replace(
            self.model,
            robot_folder=str(dataset.robot.folder),
            error=error_summary(series, dataset.robot.joints),
            recordings=tuple(series),
        )


@dataclass(frozen=True)
class Comparison:
    """A saved model applied to recordings that it may never have seen."""

    robot: str
    model: str
    recordings: tuple[CurrentSeries, ...]
    error: ErrorSummary
    findings: tuple[Finding, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """What limits the comparison, in words."""
        return tuple(map(note, self.findings))


def save_model(
    result: Identification | SavedModel,
    path: str | Path,
    dataset: Path | None = None,
    effect_files: Sequence[Path] = (),
) -> None:
    """Write the answer as a JSON file, whole or not at all. dataset: the folder that it was identified from.

    effect_files: of effects outside the catalogue; the model names them, if possible relative to itself. For a loaded
    model both default to those of its file.
    """
    if isinstance(result, SavedModel):
        dataset, effect_files = dataset or result.dataset, effect_files or result.effect_files
    folder = Path(path).resolve().parent
    answer = model_json(result, dataset, effect_files, folder, words=False)
    try:
        answer = model_json(result, dataset, effect_files, folder)
    finally:  # the file also has the notes as codes
        write_text_atomically(Path(path), json.dumps(answer, indent=1) + "\n")


def _named_from(folder: Path | None, file: Path) -> str:
    if folder is None or not file.is_relative_to(folder):
        return str(file)
    return str(file.relative_to(folder))


def model_json(
    result: Identification | SavedModel,
    dataset: Path | None = None,
    effect_files: Sequence[Path] = (),
    folder: Path | None = None,
    *,
    words: bool = True,
) -> dict[str, Any]:
    """The content of a model file; see `save_model`. folder: of the future file; words: see `to_json`."""
    model = result.model if isinstance(result, SavedModel) else result
    answer = to_json(model, result.recordings, words=words) | {"versions": versions().named()}
    if dataset is not None:
        answer["dataset"] = str(dataset.resolve())
    if effect_files:
        answer["effect_files"] = [_named_from(folder, file.resolve()) for file in effect_files]
    return answer


def load_model(path: str | Path) -> SavedModel:
    """Read a model file. Raises BenchError that names the file and its fault."""
    path = Path(path)
    if path.is_dir():
        raise BenchError(f"{path}: a folder, not a model file that `bench identify --json` wrote")
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchError(f"{path}: {error.strerror or error}") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: not a model file ({error})") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise BenchError(f"{path}: not a model file that `bench identify --json` wrote")
    try:
        dataset = Path(content["dataset"]) if content.get("dataset") else None
        recordings = tuple(
            ModelledRecording(str(recording["name"]), str(recording["use"]), recording["payload"])
            for recording in content["recordings"]
        )
        files = tuple(path.parent / str(file) for file in content.get("effect_files", ()))
        return SavedModel(path, from_json(content), dataset, recordings, files)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise BenchError(f"{path}: damaged model file: {type(error).__name__} at {error}") from None


def read_identification(path: Path, problem: Problem) -> Identification:
    """A model file as an answer, with its modelled currents for a problem's recordings."""
    saved = load_model(path)
    return saved.applied_to(problem.dataset, apply_model(problem, saved).recordings)


@on_one_thread
def apply_model(problem: Problem, saved: SavedModel) -> Comparison:
    """Model the currents of every recording of a dataset with a saved model; nothing is fitted.

    Recordings and catalogue are the problem's; effects and filters are the model's. Raises BenchError if model and
    dataset do not match: another robot, or a payload whose parameters neither the dataset nor the model has.
    """
    prepared, solution = applied(problem, saved)
    dataset = problem.dataset
    series = tuple(modelled_series(prepared, observation, solution) for observation in prepared.observations)
    joints = [actuator.joint for actuator in dataset.robot.actuators]
    findings = (*without_values_by_log(prepared), *locked_findings(dataset.robot.locked))
    return Comparison(dataset.robot.name, str(saved.path), series, error_summary(series, joints), findings)


def applied(problem: Problem, saved: SavedModel) -> tuple[Prepared, Solution]:
    """The equations of every recording of a dataset, and a saved model as their solution; see `apply_model`."""
    dataset = problem.dataset
    joints = list(dataset.robot.joints)
    model = saved.model
    if model.robot != dataset.robot.name or set(dataset.robot.driven) != set(model.drive_gains):
        raise BenchError(
            f"{saved.path}: a model of {model.robot} ({', '.join(model.drive_gains)}), but {dataset.folder} is of "
            f"{dataset.robot.name} ({', '.join(dataset.robot.driven)})"
        )
    refuse_other_locks(dataset.robot, model.locked, str(saved.path))
    # a log in another folder is another log, even of the same name
    if saved.dataset is None or saved.dataset.resolve() != dataset.folder.resolve():
        strangers = tuple(
            replace(recording, part_of=str(dataset.folder / recording.log))
            for recording in dataset.recordings
        )
        dataset = replace(dataset, recordings=strangers)
    known = with_saved_effects(problem.catalogue, saved)
    prepared = prepare(
        Problem(dataset, known, model.effects, model.settings), fitted_only=False, logs=saved.fitted
    )
    instances = [_shaped(instance, saved) for instance in prepared.effects]
    solution = Solution(
        theta=_theta(prepared, saved),
        gains=np.array([model.drive_gains[joint].value for joint in joints]),
        weights=np.ones(len(joints)),
        domain="current",
        gains_fitted=False,
    )
    return with_effects(prepared, instances, present_model(prepared, solution)), solution


def with_saved_effects(catalogue: Mapping[str, Effect], saved: SavedModel) -> Mapping[str, Effect]:
    """A catalogue, with the effects that it lacks from the files that a model names.

    Raises BenchError that names the model and an unreadable file.
    """
    if {effect.partition(":")[0].partition("@")[0] for effect in saved.model.effects} <= set(catalogue):
        return catalogue
    loaded: dict[str, Effect] = {}
    for file in saved.effect_files:
        if not file.is_file():
            raise BenchError(f"{saved.path}: its effect file {file} is missing")
        loaded |= load_effects(file)
    return dict(sorted({**loaded, **catalogue}.items()))


def _theta(prepared: Prepared, saved: SavedModel) -> np.ndarray:
    known = saved.parameters
    values = [_base_value(name, known, saved) for name in prepared.model.base.names]
    for payload, index in prepared.layout.payloads.items():
        for name in payload_parameter_names(payload, index):
            if name not in known:
                declared = 10 - len(payload_columns(prepared.dataset.payloads[payload]).unknown)
                raise BenchError(
                    f"{saved.path}: the model does not know {name}, and the dataset declares {declared} of 10 "
                    f"parameters of payload {payload!r}"
                )
            values.append(known[name])
    extra = prepared.dataset.robot.redundant[: prepared.layout.redundant]
    values += [saved.model.drive_gains[actuator.joint].value - actuator.gain for actuator in extra]
    for instance in prepared.effects:
        values += [_effect_value(instance, parameter.name, saved) for parameter in instance.effect.parameters]
    return np.array(values)


def _shaped(instance: EffectInstance, saved: SavedModel) -> EffectInstance:
    effect = instance.effect
    values = {shape.name: _effect_value(instance, shape.name, saved) for shape in effect.shape}
    linear = {
        parameter.name: _effect_value(instance, parameter.name, saved) for parameter in effect.parameters
    }
    return replace(instance, effect=replace(effect, **values).about(linear))


def _effect_value(instance: EffectInstance, name: str, saved: SavedModel) -> float:
    joints = saved.model.effect_parameters.get(instance.name, {})
    try:
        return joints[instance.place][name].value
    except KeyError:
        where = f" at {instance.place!r}" if instance.place != ROBOT else ""
        raise BenchError(f"{saved.path}: no {name} of {instance.name}{where}") from None


def _base_value(name: str, known: Mapping[str, float], saved: SavedModel) -> float:
    if name in known:
        return known[name]
    if name in saved.model.left_out:
        return 0.0
    raise BenchError(
        f"{saved.path}: no base parameter {name}; the robot's geometry or its base parameters have changed "
        "since: identify again"
    )


def comparison_json(comparison: Comparison, *, words: bool = True) -> dict[str, Any]:
    """The comparison as plain data; words: whether with its notes."""
    answer = finite(
        {
            "robot": comparison.robot,
            "model": comparison.model,
            "error": asdict(comparison.error),
            "recordings": [
                {"name": trace.name, "use": trace.use, "payload": trace.payload}
                for trace in comparison.recordings
            ],
            "notes": list(comparison.notes) if words else [],
        }
    )
    return dict(answer)
