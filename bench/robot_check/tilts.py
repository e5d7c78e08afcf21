"""Hinges that are nearly parallel: an angle that the drawing rounds, such as 1.57 for a right one.

Hinges of a planar linkage that are not parallel close in one pose only, or nowhere.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bench.model.geometry import Geometry
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.report import RobotReport


def with_tilts(report: RobotReport, geometry: Geometry) -> RobotReport:
    """The report with the hinges that are tilted most: a note, but the first fault where something else fails, or where
    closures make a motor redundant, since such hinges take freedom.
    """
    widest = max(_tilts(geometry), key=lambda tilt: tilt[2], default=None) if geometry.closed else None
    if widest is None:
        return report
    first, second, angle = widest
    values = {"first": first, "second": second, "angle": angle}
    if not report.failures and not geometry.robot.redundant:
        return replace(report, checks=(*report.checks, Check(CheckCode.NEARLY_PARALLEL, "note", values)))
    at = report.checks.index(report.failures[0]) if report.failures else len(report.checks)
    tilted = Check(CheckCode.NEARLY_PARALLEL, "failed", values)
    return replace(report, checks=(*report.checks[:at], tilted, *report.checks[at:]))


def _tilts(geometry: Geometry) -> Iterator[tuple[str, str, float]]:
    """Pairs of hinges, one on the other or both on one body, whose axes are nearly parallel, in all poses alike."""
    hinges = [(index, joint) for index, joint in enumerate(geometry.joints) if joint.kind == "hinge"]
    for place, (_, joint) in enumerate(hinges):
        for other_index, other in hinges[:place]:
            if joint.parent not in (other_index, other.parent):
                continue
            on_it = joint.parent == other_index
            axes = [joint.placement.rotation @ joint.axis]
            axes.append(other.axis if on_it else other.placement.rotation @ other.axis)
            angle = float(np.linalg.norm(np.cross(*axes)))
            if PLAUSIBLE.rounded_tilt < angle < PLAUSIBLE.meant_tilt:
                yield other.name, joint.name, angle
