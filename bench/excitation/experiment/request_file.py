"""The file of limits, with values from the command line."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import first_mistake, read_toml
from bench.dataset.robot import Robot
from bench.excitation.experiment.request import PER, ExperimentTable, by_unit


def asked_table(file: Path | None, given: Mapping[str, Any], robot: Robot) -> ExperimentTable:
    """The file's table, or an empty one, with values of the command line in place of its keys.

    `payload_mass` is the mass of the payload; `velocity` and `acceleration` are pairs of a number and its unit.
    Raises BenchError in one line.
    """
    table = ExperimentTable() if file is None else read_toml(file, ExperimentTable)
    given = {**given, **{key: by_unit(key, given.get(key, ()), robot) for key in PER}}
    changes = {key: value for key, value in given.items() if value is not None}
    mass = changes.pop("payload_mass", None)
    content = {**table.model_dump(exclude_unset=True), **changes}
    if mass is not None:
        content["payload"] = {**(content.get("payload") or {}), "mass": mass}
    try:
        return ExperimentTable.model_validate(content)
    except ValidationError as error:
        raise BenchError(f"limits: {first_mistake(error)}") from error
