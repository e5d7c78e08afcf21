"""The report of a robot as plain values for JSON."""

from dataclasses import asdict
from typing import Any

from bench.robot_check.report import RobotReport
from bench.robot_check.singularity import nearest_in_words


def report_json(report: RobotReport) -> dict[str, Any]:
    """All that the report holds, under the names of its fields; SI units."""
    mobility, singularity, base = report.mobility, report.singularity, report.base
    return {
        "robot": report.robot.name,
        "model": report.robot.model_path.name,
        "ok": not report.failures,
        "joints": [asdict(joint) for joint in report.joints],
        "loops": [asdict(loop) for loop in report.loops],
        "degrees_of_freedom": None
        if mobility is None
        else {**asdict(mobility), "remaining": mobility.remaining},
        "singularity": None
        if singularity is None
        else {**asdict(singularity), "nearest": nearest_in_words(singularity)},
        "base_parameters": []
        if base is None
        else [
            {"name": name, "unit": unit, "grouping": grouping}
            for name, unit, grouping in zip(base.names, base.units, base.descriptions, strict=True)
        ],
        "checks": [asdict(check) for check in report.checks],
    }
