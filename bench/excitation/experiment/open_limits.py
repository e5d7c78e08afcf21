"""Limits that an enclosure leaves open: not kept by all of it."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from bench.excitation.bounds import PROOF
from bench.excitation.experiment.enclosed_loops import Enclosure
from bench.excitation.experiment.enclosed_torques import enclosed_torques
from bench.excitation.experiment.nominal import Nominal
from bench.excitation.experiment.request import Box
from bench.excitation.experiment.room import Room, tool_point
from bench.excitation.limits import passive_room
from bench.model.balls import balls, dense_balls
from bench.model.geometry import Geometry
from bench.model.mobility import column_scales
from bench.model.nodes import robot_length


class Kept(StrEnum):
    """Limits of a motion."""

    LOOPS = "loops"
    AMPLIFICATION = "amplification"
    SINGULAR = "distance from singular poses"
    PASSIVE_RANGE = "passive range"
    WORKSPACE = "workspace"
    TORQUE = "torque"


Limit = tuple[Kept, str]  # and the joint or box that it is of, "" for the whole robot


@dataclass(frozen=True)
class Margin:
    """Margin to a limit in intervals: in their middles, and its lower bound in each interval, (K,); if the latter is
    above zero, the limit is kept.
    """

    middle: np.ndarray
    least: np.ndarray


def margins(nominal: Nominal, room: Room, payload: str | None, enclosure: Enclosure) -> dict[Limit, Margin]:
    """Margins of all limits, always in the same order."""
    geometry = nominal.model.geometry
    by_limit: dict[Limit, Margin] = {}
    if geometry.closed:
        sizes = np.abs(enclosure.motion.jacobian)
        by_limit[Kept.AMPLIFICATION, ""] = _below(room.joint.amplification, sizes, sizes + enclosure.jacobian)
        by_limit[Kept.SINGULAR, ""] = _singular(geometry, room.joint.held, enclosure)
    for limit in passive_room(geometry):
        at, radius = limit.at(enclosure.motion.q), enclosure.passed[:, limit.displacement.start]
        distance = np.minimum(at - limit.low, limit.high - at)
        by_limit[Kept.PASSIVE_RANGE, limit.joint] = Margin(distance, distance - radius)
    if room.boxes:
        points, radii = _tool(geometry, enclosure)
        for i, box in enumerate(room.boxes):
            middle, least = (_clear(box, points, radius) for radius in (np.zeros_like(points), radii))
            by_limit[Kept.WORKSPACE, str(i)] = Margin(middle, least)
    limited = np.flatnonzero(np.isfinite(room.torque))
    if len(limited):
        middle, largest = enclosed_torques(nominal, payload, enclosure)
        for j in limited.tolist():
            most = room.torque[j]
            by_limit[Kept.TORQUE, geometry.robot.joints[j]] = Margin(
                most - middle[:, j], most - largest[:, j] * (1.0 + PROOF.rounding)
            )
    return by_limit


def _below(most: float, middle: np.ndarray, largest: np.ndarray) -> Margin:
    """Margin of quantities with the bound `most`; middle, largest (K, nv, n)."""
    return Margin(most - middle.max(axis=(1, 2)), most - largest.max(axis=(1, 2)) * (1.0 + PROOF.rounding))


def _singular(geometry: Geometry, least: float, enclosure: Enclosure) -> Margin:
    """Margin of the smallest singular value of the scaled closures by the passive joints, which changes by at most the
    norm of the matrix's change (Weyl). It is computed only if its lower bound, one over the inverse's norm, is too
    small for a proof.

    See `scaled_jacobians`; if a row is scaled by its largest entry, both vary.
    """
    passive, linear = geometry.passive, enclosure.linear
    sizes = np.ones(linear.middle.shape[:2])  # that rows are divided by
    row = 0
    for loop in geometry.loops:
        sizes[:, row : row + 3] = robot_length(geometry)
        row += loop.size
    gears = slice(row, row + len(geometry.couplings))
    scales = column_scales(geometry)
    sizes[:, gears] = np.abs(linear.middle[:, gears] * scales).max(axis=2, initial=0.0)
    middle = linear.middle[:, :, passive] * scales[passive] / sizes[:, :, None]
    radius = linear.radius[:, :, passive] * scales[passive] / sizes[:, :, None]
    strays = (linear.radius[:, gears] * scales).max(axis=2, initial=0.0) / sizes[:, gears]
    radius[:, gears] = np.where(
        strays[:, :, None] < 1.0,
        (radius[:, gears] + np.abs(middle[:, gears]) * strays[:, :, None]) / (1.0 - strays[:, :, None]),
        np.inf,
    )
    straying = np.linalg.norm(radius, axis=(1, 2)) * (1.0 + PROOF.rounding)
    inverse = linear.inverse / scales[passive, None] * sizes[:, None, :]
    off = np.linalg.norm(linear.rounding / scales[passive], axis=1)
    values = (1.0 - off) / np.linalg.norm(inverse, axis=(1, 2))
    open_still = ~(values * (1.0 - PROOF.rounding) - straying > least)
    values[open_still] = np.linalg.svd(middle[open_still], compute_uv=False)[:, -1]
    return Margin(values - least, values * (1.0 - PROOF.rounding) - straying - least)


def _tool(geometry: Geometry, enclosure: Enclosure) -> tuple[np.ndarray, np.ndarray]:
    """Tool positions in the middles, (K, 3) m, and their radii along each axis."""
    point = tool_point(geometry, balls(enclosure.motion.q.T, enclosure.q.T))
    middle, radius = dense_balls(point, len(enclosure.motion.time))
    return middle.T, radius.T


def _clear(box: Box, points: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Distance (K,) m between points (K, 3) with radii and the walls of a box that they keep inside or outside of."""
    low, high = np.asarray(box.low), np.asarray(box.high)
    if box.keep == "inside":
        return np.asarray(np.minimum(points - low, high - points).min(axis=1) - radii.max(axis=1))
    return np.asarray((np.maximum(low - points, points - high) - radii).max(axis=1))
