"""One step that closes the loops, and the rates at the closed pose, for a block of samples (equations 2-4).

Blocks of few samples replay a tape of this arithmetic, see `bench.model.scalars`; long ones fill NumPy's calls by
themselves, and a tape of theirs would leave the cache.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np

from bench.model.bounds import MEMORY
from bench.model.closure import Closures, closures_of, loop_bias, loop_rows
from bench.model.elimination import Elimination, Row, eliminate
from bench.model.geometry import Geometry
from bench.model.kinematics import Frames, frames_of
from bench.model.scalars import Program, Reused, Rows, Scalar, Tape, TapeRun, dot, minus, plus


@dataclass(frozen=True)
class LoopEquations:
    """The equations of the loops at a pose: frames, rows by the motors' velocities, and by the passive ones reduced."""

    frames: Frames
    rows: list[Row]
    elimination: Elimination

    @property
    def columns(self) -> tuple[int, ...]:
        """The passive velocities that the loops determine (k), in the order of the elimination."""
        return self.elimination.columns


class Closing(Protocol):
    """Closes a block of samples: `correct` as often as is needed, `amplify` and `rates` at the last pose of these."""

    def correct(self, q: np.ndarray) -> tuple[Sequence[Scalar] | np.ndarray, dict[int, Scalar]]:
        """Residual of every row, and the correction by passive velocity, at poses q (nq, N)."""

    def amplify(self) -> list[dict[int, Scalar]]:
        """For every motor the passive velocities at its unit speed."""

    def rates(self, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[Rows, Rows]:
        """Velocities and accelerations of all joints (nv each) for those of the active joints, (N, n) each."""


class Direct:
    """Worked out as it is."""

    def __init__(self, closures: Closures) -> None:
        self._closures = closures
        self._linear: LoopEquations
        self._amplification: list[dict[int, Scalar]]

    def correct(self, q: np.ndarray) -> tuple[Sequence[Scalar] | np.ndarray, dict[int, Scalar]]:
        """See `Closing`."""
        self.__dict__.pop("_linear", None)  # two poses' equations are never there at once
        self._linear, residual, correction = _correction(self._closures, q)
        return residual, correction

    def amplify(self) -> list[dict[int, Scalar]]:
        """See `Closing`."""
        self._amplification = _amplification(self._closures, self._linear)
        return self._amplification

    def rates(self, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[Rows, Rows]:
        """See `Closing`."""
        active = _columns(velocity), _columns(acceleration)
        return _rates(self._closures, self._linear, self._amplification, *active)


class Replayed:
    """Worked out by replaying the tape of `Direct`'s arithmetic."""

    def __init__(self, recorded: "ClosingTape", samples: int) -> None:
        self._recorded = recorded
        self._replay: TapeRun = recorded.program.replay(samples)

    def correct(self, q: np.ndarray) -> tuple[Sequence[Scalar] | np.ndarray, dict[int, Scalar]]:
        """See `Closing`."""
        columns = self._recorded.columns
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            outputs = self._replay.run(0, q)
        first = len(outputs) - len(columns)
        return outputs[:first], dict(zip(columns, outputs[first:], strict=True))

    def amplify(self) -> list[dict[int, Scalar]]:
        """See `Closing`."""
        columns = self._recorded.columns
        outputs = self._replay.run(1, ())
        per_motor = outputs.reshape(self._recorded.motors, len(columns), outputs.shape[1])
        return [dict(zip(columns, values, strict=True)) for values in per_motor]

    def rates(self, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[Rows, Rows]:
        """See `Closing`."""
        outputs = self._replay.run(2, [*velocity.T, *acceleration.T])
        nv = len(outputs) // 2
        return outputs[:nv], outputs[nv:]


@dataclass(frozen=True)
class ClosingTape:
    """The tape of a geometry's closures; `columns` as in `LoopEquations`."""

    program: Program
    columns: tuple[int, ...]
    motors: int


def closing_tape(geometry: Geometry) -> ClosingTape:
    """Record what `Direct` does, stage by stage: `correct`, `amplify`, `rates`."""
    closures, tape = closures_of(geometry), Tape()
    linear, residual, correction = _correction(closures, tape.inputs(geometry.nq))
    tape.end_stage([*residual, *(correction[column] for column in linear.columns)])
    amplification = _amplification(closures, linear)
    tape.end_stage([column[index] for column in amplification for index in linear.columns])
    n = len(closures.active)
    v, a = _rates(closures, linear, amplification, tape.inputs(n), tape.inputs(n))
    tape.end_stage([*v, *a])
    return ClosingTape(tape.program(), linear.columns, n)


@lru_cache(maxsize=MEMORY.geometries)
def _reused(_: Geometry) -> Reused[ClosingTape]:
    return Reused()


def closing_of(geometry: Geometry, samples: int) -> Closing:
    """The faster way to close a block of so many samples."""
    tape = _reused(geometry).get(samples, lambda: closing_tape(geometry))
    return Direct(closures_of(geometry)) if tape is None else Replayed(tape, samples)


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
    """The rows with these columns alone."""
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
