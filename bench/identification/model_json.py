"""An identification as plain data and back: the only module that knows the layout of a model file."""

import math
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from bench.basics.plain_data import finite
from bench.dataset.robot_locked import locked_as_data, locked_from_data
from bench.identification.decision import DecisionRule
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.result import (
    BandPoint,
    CurrentSeries,
    DriveGain,
    ErrorSummary,
    Identification,
    ModelledRecording,
    Parameter,
    Quantity,
)
from bench.identification.tolerances import Tolerances
from bench.signals.settings import FilterSettings

FORMAT = 1


def to_json(
    result: Identification,
    recordings: Sequence[CurrentSeries | ModelledRecording] | None = None,
    *,
    words: bool = True,
) -> dict[str, Any]:
    """The answer as plain data, ready for JSON; a number that is not finite becomes null.

    recordings: those of an answer that no longer has their currents. words: whether to write notes as sentences, in
    addition to their codes.
    """

    def quantity(quantity: Quantity) -> dict[str, Any]:
        return {"value": quantity.value, "std": quantity.std, "unit": quantity.unit}

    answer = {
        "format": FORMAT,
        "robot": result.robot,
        "method": result.method,
        "redundant": list(result.redundant),
        "locked": locked_as_data(result.locked),
        "effects": list(result.effects),
        "gains_fitted": result.gains_fitted,
        "drive_gains": {
            joint: {
                **quantity(gain),
                "nominal": gain.nominal,
                "fitted": gain.fitted,
                "determined": gain.fitted and gain.determined,
            }
            for joint, gain in result.drive_gains.items()
        },
        "parameters": [
            {"name": parameter.name, **quantity(parameter), "grouping": parameter.grouping}
            for parameter in result.parameters
        ],
        "left_out": list(result.left_out),
        "effect_parameters": {
            effect: {
                joint: {name: quantity(value) for name, value in values.items()}
                for joint, values in joints.items()
            }
            for effect, joints in result.effect_parameters.items()
        },
        "error": asdict(result.error),
        "rank": result.rank,
        "unknowns": result.unknowns,
        "condition": result.condition,
        "scaled_condition": result.scaled_condition,
        "deviations": result.deviations,
        "std_from": result.std_from,
        "settings": asdict(result.settings),
        "bandwidths": [_band_point(point) for point in result.bandwidths],
        "covariance": result.covariance.tolist(),
        "covariance_rows": [asdict(unknown) for unknown in result.covariance_rows],
        "recordings": [
            {"name": trace.name, "use": trace.use, "payload": trace.payload}
            for trace in (result.recordings if recordings is None else recordings)
        ],
        "decision_rule": asdict(result.rule),
        "tolerances": asdict(result.tolerances),
        "notes": list(result.notes) if words else [],
        "findings": [_finding(finding) for finding in result.findings],
    }
    return dict(finite(answer))


def from_json(content: dict[str, Any]) -> Identification:
    """The answer that `to_json` wrote, without currents and without a robot's folder.

    Raises KeyError, TypeError, ValueError or AttributeError for other content.
    """
    return Identification(
        robot=str(content["robot"]),
        robot_folder="",
        method=str(content["method"]),
        effects=tuple(content["effects"]),
        drive_gains={
            joint: DriveGain(*_quantity(drive_gain), float(drive_gain["nominal"]))
            for joint, drive_gain in content["drive_gains"].items()
        },
        gains_fitted=bool(content["gains_fitted"]),
        parameters=tuple(
            Parameter(*_quantity(parameter), str(parameter["name"]), str(parameter["grouping"]))
            for parameter in content["parameters"]
        ),
        effect_parameters={
            effect: {
                joint: {name: Quantity(*_quantity(value)) for name, value in values.items()}
                for joint, values in joints.items()
            }
            for effect, joints in content["effect_parameters"].items()
        },
        covariance=np.array(content["covariance"], dtype=float),
        covariance_rows=tuple(Unknown(**row) for row in content.get("covariance_rows", ())),
        rank=int(content["rank"]),
        unknowns=int(content["unknowns"]),
        condition=_or_infinite(content["condition"]),
        scaled_condition=_or_infinite(content["scaled_condition"]),
        error=ErrorSummary(**content["error"]),
        settings=FilterSettings(**{**content["settings"], "border": tuple(content["settings"]["border"])}),
        deviations=content["deviations"],
        recordings=(),
        left_out=tuple(content["left_out"]),
        findings=_findings(content),
        std_from=content.get("std_from", "noise"),
        redundant=tuple(content.get("redundant", ())),
        locked=locked_from_data(content.get("locked", {})),
        bandwidths=tuple(map(_band_point_from, content.get("bandwidths", ()))),
        rule=TypeAdapter(DecisionRule).validate_python(content.get("decision_rule", {})),
        tolerances=TypeAdapter(Tolerances).validate_python(content.get("tolerances", {})),
    )


def _band_point(point: BandPoint) -> dict[str, Any]:
    values = [
        {**asdict(unknown), "value": value, "std": std} for unknown, (value, std) in point.values.items()
    ]
    return {**asdict(replace(point, values={})), "values": values}


def _band_point_from(content: dict[str, Any]) -> BandPoint:
    values = {
        Unknown(row["kind"], row["name"], row["place"], row["effect"]): (row["value"], row["std"])
        for row in content["values"]
    }
    return BandPoint(**{**content, "values": values})


def _finding(finding: Finding) -> dict[str, Any]:
    """As JSON; counts are written as floats, as they are read back."""
    return {**asdict(finding), "numbers": {name: float(value) for name, value in finding.numbers.items()}}


def _findings(content: dict[str, Any]) -> tuple[Finding, ...]:
    """The findings of a file; of an earlier version, its sentences."""
    if "findings" not in content:
        return tuple(Finding(Code.TOLD, (str(note),)) for note in content["notes"])
    return tuple(
        Finding(
            Code(finding["code"]),
            tuple(finding["names"]),
            tuple(Unknown(**unknown) for unknown in finding["of"]),
            {name: _or_infinite(value) for name, value in finding["numbers"].items()},
            str(finding["unit"]),
        )
        for finding in content["findings"]
    )


def _quantity(content: dict[str, Any]) -> tuple[float, float, str]:
    return _number(content["value"]), _or_infinite(content["std"]), str(content["unit"])


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{value!r} is not a number")
    return float(value)


def _or_infinite(value: Any) -> float:
    """A number; JSON has null for infinity."""
    return math.inf if value is None else float(value)
