"""Loop closures: residual, Jacobian and velocity-product terms for all samples at once (equations 2-4).

Rows are the stacked loops, `second` minus `first` anchor, in the world: three of position and, for a weld,
three of orientation [m, rad].
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.model.elimination import Row
from bench.model.geometry import Anchor, Geometry
from bench.model.kinematics import (
    End,
    Frames,
    Link,
    ancestors,
    end_bias,
    end_of,
    end_point,
    end_rotation,
    frames_of,
    link_columns,
    link_of,
    rates_of,
)
from bench.model.scalars import Scalar, Vector, add, cross, dense, minus, scaled, subtract


@dataclass(frozen=True)
class Side:
    """One anchor of a loop and the links that move it, root first."""

    end: End
    links: tuple[Link, ...]


@dataclass(frozen=True)
class Closures:
    """The loops of a robot and the links that move them (in tree order), prepared for many samples."""

    links: tuple[Link, ...]
    loops: tuple[tuple[Literal["connect", "weld"], Side, Side], ...]
    active: tuple[int, ...]
    passive: tuple[int, ...]
    nv: int


def closures_of(geometry: Geometry) -> Closures:
    """What the loop closures need of the geometry, as constants."""
    chains = {
        anchor.joint: ancestors(geometry, anchor.joint)
        for loop in geometry.loops
        for anchor in (loop.first, loop.second)
    }
    moving = sorted({joint for chain in chains.values() for joint in chain})
    links = {index: link_of(index, geometry.joints[index]) for index in moving}

    def side_of(anchor: Anchor) -> Side:
        return Side(end_of(anchor), tuple(links[i] for i in chains[anchor.joint]))

    return Closures(
        links=tuple(links.values()),
        loops=tuple((loop.kind, side_of(loop.first), side_of(loop.second)) for loop in geometry.loops),
        active=tuple(int(i) for i in geometry.active),
        passive=tuple(int(i) for i in geometry.passive),
        nv=geometry.nv,
    )


def loop_rows(closures: Closures, frames: Frames) -> tuple[list[Scalar], list[Row]]:
    """Residual and Jacobian of every row: f_t and f_p of equation 2, and A_t, A_p, B_t, B_p of equation 3.

    The Jacobian is by tree velocities, with an entry only where a joint moves the loop. Its orientation rows
    are exact where the loop is closed.
    """
    residual: list[Scalar] = []
    rows: list[Row] = []
    for kind, first, second in closures.loops:
        from_point, to_point = end_point(frames, first.end), end_point(frames, second.end)
        residual += subtract(to_point, from_point)
        linear: dict[int, Vector] = {}
        angular: dict[int, Vector] = {}
        for side, point, collect in ((first, from_point, _taken), (second, to_point, _given)):
            for link in side.links:
                for index, velocity, turning in link_columns(link, frames, point):
                    collect(linear, index, velocity)
                    if kind == "weld":
                        collect(angular, index, turning)
        rows += _rows(linear)
        if kind == "weld":
            residual += _turn_between(frames, first.end, second.end)
            rows += _rows(angular)
    return residual, rows


def _given(columns: dict[int, Vector], index: int, vector: Vector) -> None:
    columns[index] = add(columns[index], vector) if index in columns else vector


def _taken(columns: dict[int, Vector], index: int, vector: Vector) -> None:
    x, y, z = vector
    columns[index] = minus(0.0, x), minus(0.0, y), minus(0.0, z)


def _rows(columns: dict[int, Vector]) -> list[Row]:
    rows: list[Row] = [{}, {}, {}]
    for index, vector in columns.items():
        for row, value in zip(rows, vector, strict=True):
            if not (isinstance(value, float) and value == 0.0):
                row[index] = value
    return rows


def _turn_between(frames: Frames, first: End, second: End) -> Vector:
    """Sine of the angle from the first frame to the second along its axis (3)."""
    a, b = end_rotation(frames, first), end_rotation(frames, second)
    return scaled(add(add(cross(a[0], b[0]), cross(a[1], b[1])), cross(a[2], b[2])), 0.5)


def loop_bias(closures: Closures, frames: Frames, v: list[Scalar]) -> list[Scalar]:
    """Time derivative of the Jacobian times the tree velocities v (nv of them), by row, as in equation 4."""
    rates = rates_of(closures.links, frames, v)
    bias: list[Scalar] = []
    for kind, first, second in closures.loops:
        bias += subtract(end_bias(rates, frames, second.end), end_bias(rates, frames, first.end))
        if kind == "weld":
            ends = rates.angular_bias[second.end.joint], rates.angular_bias[first.end.joint]
            bias += subtract(*ends)
    return bias


def loop_residual(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """What keeps every loop from being closed at q (nq, N): (m, N) [m, rad]."""
    closures = closures_of(geometry)
    return dense(loop_rows(closures, frames_of(closures.links, q))[0], q.shape[1])


def loop_jacobian(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """Derivative of the residual by the tree velocities at q (nq, N): (m, nv, N)."""
    closures = closures_of(geometry)
    rows = loop_rows(closures, frames_of(closures.links, q))[1]
    jacobian = np.zeros((len(rows), closures.nv, q.shape[1]))
    for i, row in enumerate(rows):
        for index, value in row.items():
            jacobian[i, index] = value
    return jacobian
