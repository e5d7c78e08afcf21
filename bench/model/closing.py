"""One step that closes the loops, and the rates at the closed pose, for a block of samples (equations 2-4)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.model.closure import Closures, closures_of, loop_bias, loop_rows
from bench.model.elimination import Elimination, Row, eliminate
from bench.model.geometry import Geometry
from bench.model.kinematics import Frames, frames_of
from bench.model.scalars import Rows, Scalar, dot, minus, plus


@dataclass(frozen=True)
class LoopEquations:
    """The loop equations at a pose: frames, rows by the motors' velocities, and reduced rows by the passive ones."""

    frames: Frames
    rows: list[Row]
    elimination: Elimination

    @property
    def columns(self) -> tuple[int, ...]:
        """The passive velocities that the loops determine (k), in the order of the elimination."""
        return self.elimination.columns


class Closing:
    """Closes a block of samples: `correct` as often as needed, then `amplify` and `rates` at the last pose."""

    def __init__(self, geometry: Geometry) -> None:
        self._closures = closures_of(geometry)
        self._linear: LoopEquations
        self._amplification: list[dict[int, Scalar]]

    def correct(self, q: np.ndarray) -> tuple[Sequence[Scalar], dict[int, Scalar]]:
        """Residual of every row, and the correction by passive velocity, at poses q (nq, N)."""
        self.__dict__.pop("_linear", None)  # never holds two poses' equations at once
        self._linear, residual, correction = _correction(self._closures, q)
        return residual, correction

    def amplify(self) -> list[dict[int, Scalar]]:
        """For every motor the passive velocities at its unit speed."""
        self._amplification = _amplification(self._closures, self._linear)
        return self._amplification

    def rates(self, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[Rows, Rows]:
        """Velocities and accelerations of all joints (nv each) for those of the active joints, (N, n) each."""
        active = _columns(velocity), _columns(acceleration)
        return _rates(self._closures, self._linear, self._amplification, *active)


def _correction(closures: Closures, q: Rows) -> tuple[LoopEquations, list[Scalar], dict[int, Scalar]]:
    frames = frames_of(closures.links, q)
    residual, rows = loop_rows(closures, frames)
    motors, passive = _columns_of(rows, closures.active), _columns_of(rows, closures.passive)
    del rows
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        elimination = eliminate(passive)
        correction = elimination.solve([minus(0.0, value) for value in residual])
    return LoopEquations(frames, motors, elimination), residual, correction


def _columns_of(rows: Sequence[Row], columns: Sequence[int]) -> list[Row]:
    """The rows with only these columns."""
    wanted = set(columns)
    return [{column: value for column, value in row.items() if column in wanted} for row in rows]


def _amplification(closures: Closures, linear: LoopEquations) -> list[dict[int, Scalar]]:
    motors = [[minus(0.0, row.get(index, 0.0)) for row in linear.rows] for index in closures.active]
    return [linear.elimination.solve(right) for right in motors]


def _rates(
    closures: Closures,
    linear: LoopEquations,
    amplification: list[dict[int, Scalar]],
    velocity: list[Scalar],
    acceleration: list[Scalar],
) -> tuple[list[Scalar], list[Scalar]]:
    speeds = _tree_rates(closures, amplification, velocity)
    bias = linear.elimination.solve(
        [minus(0.0, value) for value in loop_bias(closures, linear.frames, speeds)]
    )
    rates = _tree_rates(closures, amplification, acceleration)
    return speeds, [plus(rate, bias[index]) if index in bias else rate for index, rate in enumerate(rates)]


def _tree_rates(
    closures: Closures, amplification: list[dict[int, Scalar]], motors: list[Scalar]
) -> list[Scalar]:
    """All joints' rates (nv of them) for those of the active joints."""
    rates: list[Scalar] = [0.0] * closures.nv
    for index, motor in zip(closures.active, motors, strict=True):
        rates[index] = motor
    for index in closures.passive:
        rates[index] = dot([column[index] for column in amplification], motors)
    return rates


def _columns(values: np.ndarray) -> list[Scalar]:
    return [np.ascontiguousarray(column) for column in values.T]
