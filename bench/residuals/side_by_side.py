"""Several models applied to the same recordings, and their differences."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from bench.basics.chi_squared import WITHIN_95
from bench.basics.errors import BenchError
from bench.basics.plain_data import finite
from bench.effects.select import ROBOT
from bench.identification.decision import RULE
from bench.identification.model_file import apply_model, load_model
from bench.identification.problem import Problem
from bench.identification.result import Identification, Quantity


@dataclass(frozen=True)
class ComparedModel:
    """A model with its currents for these recordings. name: distinguishes its file from the others."""

    name: str
    model: Identification


@dataclass(frozen=True)
class SideBySide:
    """Models, in the given order; changes are relative to the first."""

    robot: str
    models: tuple[ComparedModel, ...]


def side_by_side(problem: Problem, files: Sequence[Path]) -> SideBySide:
    """Apply saved models to a dataset's recordings; nothing is fitted.

    Raises BenchError for a file that is given twice, or if a model and the dataset do not match.
    """
    for file in files:
        if sum(file.resolve() == other.resolve() for other in files) > 1:
            raise BenchError(f"{file}: is given twice")
    dataset, models = problem.dataset, []
    for file, name in zip(files, distinct_names(files), strict=True):
        saved = load_model(file)
        models.append(ComparedModel(name, saved.applied_to(dataset, apply_model(problem, saved).recordings)))
    return SideBySide(dataset.robot.name, tuple(models))


def distinct_names(files: Sequence[Path]) -> list[str]:
    """Names of files with as many folders as distinguish them: 1-compare/model.json, 2-compare/model.json."""
    for parts in range(2, max(len(file.parts) for file in files)):
        names = [Path(*file.parts[-parts:]).as_posix() for file in files]
        if len(set(names)) == len(names):
            return names
    return [str(file) for file in files]


def interval(quantity: Quantity) -> tuple[float, float] | None:
    """The 95 % interval of a value; None for a given value, or one without deviation."""
    if not (0.0 < quantity.std < math.inf):
        return None
    return quantity.value - WITHIN_95 * quantity.std, quantity.value + WITHIN_95 * quantity.std


def moved_parameters(first: Identification, other: Identification) -> list[str]:
    """Names of the common base parameters with clearly different values, the largest difference first.

    The unit is the larger of the two deviations: models of the same recordings share their noise.
    """
    before = {parameter.name: parameter for parameter in first.parameters}
    moved = []
    for parameter in other.parameters:
        old = before.get(parameter.name)
        std = max(parameter.std, old.std) if old is not None else math.inf
        if old is not None and 0.0 < std < math.inf and abs(parameter.value - old.value) > RULE.shows * std:
            moved.append((abs(parameter.value - old.value) / std, parameter.name))
    return [name for _, name in sorted(moved, reverse=True)]


def effect_places(model: Identification) -> list[str]:
    """Every effect of a model with its place: viscous_friction:left; an effect of the whole robot alone."""
    return [
        effect if place == ROBOT else f"{effect}:{place}"
        for effect, places in model.effect_parameters.items()
        for place in places
    ]


def side_by_side_json(comparison: SideBySide, changed: Sequence[str]) -> dict[str, Any]:
    """The models as plain data. changed: sentences on what is different."""
    return dict(
        finite(
            {
                "robot": comparison.robot,
                "models": [
                    {
                        "name": model.name,
                        "effects": effect_places(model.model),
                        "gains_fitted": model.model.gains_fitted,
                        "error": asdict(model.model.error),
                        "drive_gains": {
                            joint: {**asdict(gain), "interval": interval(gain)}
                            for joint, gain in model.model.drive_gains.items()
                        },
                    }
                    for model in comparison.models
                ],
                "changed": list(changed),
            }
        )
    )
