"""What a result folder keeps so that its page can be written again: the command, the dataset's path, the models."""

import json
import math
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.dataset import Dataset, load_dataset
from bench.diagnose.result import Diagnosis, EffectVerdict, LadderStep, Unexplained
from bench.diagnose.split import with_judged_parts
from bench.effects import Effect, catalogue_for
from bench.errors import BenchError
from bench.estimate.model_file import apply_model, load_model, save_model
from bench.estimate.result import DriveGain, Identification, Parameter, Quantity
from bench.files import finite, write_json_atomically
from bench.report.content_run import Run

RUN_FILE = "report.json"
MODEL_FILE, AFTER_FILE, BEFORE_FILE = "model.json", "model_after.json", "model_before.json"
FORMAT = 1


@dataclass(frozen=True)
class Kept:
    """A result folder, read again. model: name of the model that was applied, "" for one that was fitted there."""

    run: Run
    dataset: Dataset
    after: Identification
    diagnosis: Diagnosis | None
    model: str


def keep_run(
    folder: Path,
    run: Run,
    dataset: Dataset,
    result: Identification,
    diagnosis: Diagnosis | None = None,
    model: str = "",
) -> None:
    """Write report.json and the models beside it, each whole or not at all."""
    save_model(result, folder / (MODEL_FILE if diagnosis is None else AFTER_FILE), dataset.folder)
    content: dict[str, Any] = {
        "format": FORMAT,
        "run": asdict(run),
        "dataset": os.path.relpath(dataset.folder, folder),
        "model": model,
    }
    if diagnosis is not None:
        save_model(diagnosis.before, folder / BEFORE_FILE, dataset.folder)
        kept = ("split", "missing", "ladder", "ranking", "unexplained")
        content["diagnosis"] = {name: _plain(getattr(diagnosis, name)) for name in kept}
    write_json_atomically(folder / RUN_FILE, finite(content))


def read_run(folder: Path) -> Kept:
    """Read a result folder and apply its models to its dataset again; nothing is fitted or searched.

    Raises BenchError naming what is missing or damaged, the dataset included.
    """
    content = read_json(folder / RUN_FILE)
    try:
        known = dict(content["run"])
        known |= {name: tuple(known[name]) for name in ("effects", "effect_files")}
        run, path, model = Run(**known), folder / content["dataset"], str(content["model"])
        found = content.get("diagnosis")
    except (KeyError, TypeError, ValueError) as error:
        raise _damaged(folder / RUN_FILE, error) from None
    if not path.is_dir():
        raise BenchError(f"{folder / RUN_FILE}: its dataset is not there any more: {path}")
    dataset = load_dataset(path)
    catalogue = catalogue_for(dataset.effect_files, [Path(one) for one in run.effect_files])
    judged = with_judged_parts(dataset)[0] if found is not None else dataset
    after = read_identification(folder / (MODEL_FILE if found is None else AFTER_FILE), judged, catalogue)
    diagnosis = None
    if found is not None:
        before = read_identification(folder / BEFORE_FILE, judged, catalogue)
        try:
            diagnosis = _diagnosis(found, before, after)
        except (KeyError, TypeError, ValueError) as error:
            raise _damaged(folder / RUN_FILE, error) from None
    return Kept(run, dataset, after, diagnosis, model)


def read_identification(
    path: Path, dataset: Dataset, catalogue: Mapping[str, Effect] | None = None
) -> Identification:
    """A model file as the answer that it was, with the currents that it gives in these recordings."""
    saved = load_model(path)
    comparison = apply_model(dataset, saved, catalogue)
    content = read_json(path)
    try:
        return Identification(
            robot=saved.robot,
            robot_folder=str(dataset.robot.folder),
            method=str(content["method"]),
            effects=saved.effects,
            drive_gains={
                joint: DriveGain(one["value"], _number(one["std"]), one["unit"], one["nominal"])
                for joint, one in content["drive_gains"].items()
            },
            gains_fitted=bool(content["gains_fitted"]),
            parameters=tuple(
                Parameter(one["value"], _number(one["std"]), one["unit"], one["name"], one["grouping"])
                for one in content["parameters"]
            ),
            effect_parameters={
                effect: {
                    joint: {
                        name: Quantity(one["value"], _number(one["std"]), one["unit"])
                        for name, one in values.items()
                    }
                    for joint, values in joints.items()
                }
                for effect, joints in content["effect_parameters"].items()
            },
            covariance=np.array(content["covariance"], dtype=float),
            rank=int(content["rank"]),
            unknowns=int(content["unknowns"]),
            condition=_number(content["condition"]),
            scaled_condition=_number(content["scaled_condition"]),
            error=comparison.error,
            settings=saved.settings,
            deviations=content["deviations"],
            recordings=comparison.recordings,
            left_out=saved.left_out,
            notes=tuple(content["notes"]),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise _damaged(path, error) from None


def read_json(path: Path) -> dict[str, Any]:
    """A JSON file that holds a table. Raises BenchError that names it."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchError(f"{path}: {error.strerror or error}") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: not a JSON file ({error})") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise BenchError(f"{path}: not a file that this version of bench wrote")
    return content


def _diagnosis(found: dict[str, Any], before: Identification, after: Identification) -> Diagnosis:
    return Diagnosis(
        robot=after.robot,
        split=str(found["split"]),
        missing=tuple(found["missing"]),
        ladder=tuple(replace(LadderStep(**one), effects=tuple(one["effects"])) for one in found["ladder"]),
        ranking=tuple(_verdict(one) for one in found["ranking"]),
        unexplained=Unexplained(
            **{**found["unexplained"], "depends_on": tuple(found["unexplained"]["depends_on"])}
        ),
        before=before,
        after=after,
    )


def _verdict(one: dict[str, Any]) -> EffectVerdict:
    numbers = {name: _number(one[name]) for name in ("error_before", "error_after", "evidence")}
    lists = {name: tuple(one[name]) for name in ("actuators", "alternatives")}
    return EffectVerdict(**{**one, **numbers, **lists})


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    return asdict(value) if hasattr(value, "__dataclass_fields__") else value


def _number(value: Any) -> float:
    """A number; null is what JSON has for infinity."""
    return math.inf if value is None else float(value)


def _damaged(path: Path, error: Exception) -> BenchError:
    return BenchError(f"{path}: damaged: {type(error).__name__} at {error}")
