"""Closures: residual, Jacobian and velocity-product terms for all samples at once (equations 2-4).

Rows are the stacked loops, `second` minus `first` anchor, in the world: three of position and, for a weld,
three of orientation [m, rad]; then one for every coupling, first less polynomial of second; then one for every idle
spin, which has a rate and no position.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.polynomial import Polynomial

from bench.model.bounds import MEMORY
from bench.model.elimination import Row
from bench.model.geometry import Anchor, Coupling, Geometry
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
from bench.model.scalars import (
    Rows,
    Scalar,
    Vector,
    add,
    constant_vector,
    cross,
    dense,
    dot,
    minus,
    minus_product,
    plus,
    plus_product,
    scaled,
    subtract,
    times,
    turned,
)
from bench.model.spin import idle_spins


@dataclass(frozen=True)
class Side:
    """One anchor of a loop and the links that move it, root first."""

    end: End
    links: tuple[Link, ...]


@dataclass(frozen=True)
class Gear:
    """A coupling: (place in q, place in v, factor) of its joints, coefficients of its polynomial and derivatives."""

    first: tuple[tuple[int, int, float], ...]
    second: tuple[tuple[int, int, float], ...]
    polynomial: tuple[float, ...]
    slope: tuple[float, ...]
    bend: tuple[float, ...]


@dataclass(frozen=True)
class Idle:
    """A rod without spin about `axis`, in the frame of the last link that moves it (root first)."""

    axis: Vector
    links: tuple[Link, ...]


@dataclass(frozen=True)
class Closures:
    """The closures of a robot and the links that move its loops (in tree order), prepared for many samples."""

    links: tuple[Link, ...]
    loops: tuple[tuple[Literal["connect", "weld"], Side, Side], ...]
    gears: tuple[Gear, ...]
    idle: tuple[Idle, ...]
    active: tuple[int, ...]
    passive: tuple[int, ...]
    nv: int

    @property
    def equations(self) -> int:
        """Number of rows."""
        loops = sum(3 if kind == "connect" else 6 for kind, *_ in self.loops)
        return loops + len(self.gears) + len(self.idle)


@lru_cache(maxsize=MEMORY.geometries)
def closures_of(geometry: Geometry) -> Closures:
    """Constants of the geometry for the closures; computed once for each geometry in use."""
    spins = idle_spins(geometry)
    chains = {
        anchor.joint: ancestors(geometry, anchor.joint)
        for loop in geometry.loops
        for anchor in (loop.first, loop.second)
    } | {spin.joint: ancestors(geometry, spin.joint) for spin in spins}
    moving = sorted({joint for chain in chains.values() for joint in chain})
    links = {index: link_of(index, geometry.joints[index]) for index in moving}

    def side_of(anchor: Anchor) -> Side:
        return Side(end_of(anchor), tuple(links[i] for i in chains[anchor.joint]))

    return Closures(
        links=tuple(links.values()),
        loops=tuple((loop.kind, side_of(loop.first), side_of(loop.second)) for loop in geometry.loops),
        gears=tuple(_gear(geometry, coupling) for coupling in geometry.couplings),
        idle=tuple(
            Idle(constant_vector(spin.axis), tuple(links[i] for i in chains[spin.joint])) for spin in spins
        ),
        active=tuple(int(i) for i in geometry.active),
        passive=tuple(int(i) for i in geometry.passive),
        nv=geometry.nv,
    )


def _gear(geometry: Geometry, coupling: Coupling) -> Gear:
    def places(side: tuple[tuple[int, float], ...]) -> tuple[tuple[int, int, float], ...]:
        joints = geometry.joints
        return tuple((joints[joint].q.start, joints[joint].v.start, factor) for joint, factor in side)

    polynomial = Polynomial(coupling.polynomial or (0.0,))
    derivatives = (polynomial, polynomial.deriv(1), polynomial.deriv(2))
    return Gear(
        places(coupling.first), places(coupling.second), *(tuple(p.coef.tolist()) for p in derivatives)
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
    for gear in closures.gears:
        argument = _combined(gear.second, frames.q, 0)
        residual.append(minus(_combined(gear.first, frames.q, 0), _value(gear.polynomial, argument)))
        rows.append(_gear_row(gear, argument))
    for idle in closures.idle:
        residual.append(0.0)
        rows.append(_idle_row(idle, frames))
    return residual, rows


def _combined(side: tuple[tuple[int, int, float], ...], values: Rows, which: int) -> Scalar:
    """Sum of factor times value, at the indices in q (which 0) or in v (which 1)."""
    total: Scalar = 0.0
    for place in side:
        total = plus_product(total, place[2], values[int(place[which])])
    return total


def _value(polynomial: tuple[float, ...], argument: Scalar) -> Scalar:
    value: Scalar = 0.0
    for coefficient in reversed(polynomial):
        value = plus(times(value, argument), coefficient)
    return value


def _gear_row(gear: Gear, argument: Scalar) -> Row:
    row: Row = {}
    for _, index, factor in gear.first:
        row[index] = plus(row.get(index, 0.0), factor)
    slope = _value(gear.slope, argument)
    for _, index, factor in gear.second:
        row[index] = minus_product(row.get(index, 0.0), factor, slope)
    return {index: value for index, value in row.items() if not (isinstance(value, float) and value == 0.0)}


def _idle_row(idle: Idle, frames: Frames) -> Row:
    last = idle.links[-1].index
    axis = turned(frames.rotation[last], idle.axis)
    row: Row = {}
    for link in idle.links:
        for index, _, turning in link_columns(link, frames, frames.origin[last]):
            value = dot(axis, turning)
            if not (isinstance(value, float) and value == 0.0):
                row[index] = value
    return row


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
    for gear in closures.gears:
        bend = _value(gear.bend, _combined(gear.second, frames.q, 0))
        rate = _combined(gear.second, v, 1)
        bias.append(minus(0.0, times(bend, times(rate, rate))))
    for idle in closures.idle:
        last = idle.links[-1].index
        bias.append(dot(turned(frames.rotation[last], idle.axis), rates.angular_bias[last]))
    return bias


def loop_residual(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """Closure error of every loop at q (nq, N): (m, N) [m, rad]."""
    closures = closures_of(geometry)
    return dense(loop_rows(closures, frames_of(closures.links, q))[0], q.shape[1])


def loop_jacobian(geometry: Geometry, q: np.ndarray, columns: np.ndarray | None = None) -> np.ndarray:
    """Derivative of the residual by the tree velocities at q (nq, N): (m, nv, N); columns: only by these."""
    closures = closures_of(geometry)
    rows = loop_rows(closures, frames_of(closures.links, q))[1]
    wanted = np.arange(closures.nv) if columns is None else columns
    place = {int(index): k for k, index in enumerate(wanted)}
    jacobian = np.zeros((len(rows), len(wanted), q.shape[1]))
    for i, row in enumerate(rows):
        for index, value in row.items():
            if index in place:
                jacobian[i, place[index]] = value
    return jacobian
