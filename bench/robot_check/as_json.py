"""A robot's report as plain values for JSON."""

from dataclasses import asdict
from typing import Any

from bench.dataset.robot_locked import locked_as_data
from bench.robot_check.outcome import Check
from bench.robot_check.report import RobotReport
from bench.robot_check.words import detail_of, name_of, nearest_singularity


def report_json(report: RobotReport) -> dict[str, Any]:
    """The report under the names of its fields; SI units."""
    mobility, singularity, base = report.mobility, report.singularity, report.base
    return {
        "robot": report.robot.name,
        "model": report.robot.model_path.name,
        "ok": not report.failures,
        "locked": locked_as_data(report.robot.locked),
        "joints": [asdict(joint) for joint in report.joints],
        "loops": [asdict(loop) for loop in report.loops],
        "degrees_of_freedom": None
        if mobility is None
        else {**asdict(mobility), "remaining": mobility.remaining},
        "singularity": None
        if singularity is None
        else {**asdict(singularity), "nearest": nearest_singularity(singularity)},
        "base_parameters": []
        if base is None
        else [
            {"name": name, "unit": unit, "grouping": grouping}
            for name, unit, grouping in zip(base.names, base.units, base.descriptions, strict=True)
        ],
        "checks": [check_json(check) for check in report.checks],
    }


def check_json(check: Check) -> dict[str, Any]:
    """A check as text, and as its code with its values."""
    return {
        "name": name_of(check),
        "verdict": check.verdict,
        "detail": detail_of(check),
        "code": check.code,
        "values": dict(check.values),
    }
