"""Arithmetic recorded once and replayed on whole groups of operations, for blocks of few samples.

Recorded values take the place of the arrays of bench.model.scalars, so that the model's functions write the tape. What
they fold away is not on it. All values of a replay are the rows of one array; operations of the same kind whose
arguments are ready together are one call of NumPy. On a hundred samples a single operation is mostly the call
(W. Kahan's "vectorise across the other dimension"): in groups it costs a fifth. Every value comes from the same
operation on the same values, so that no bit changes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from bench.model.bounds import MEMORY
from bench.model.scalars import Scalar

Made = TypeVar("Made")

_ARITHMETIC = (
    np.add,
    np.subtract,
    np.multiply,
    np.true_divide,
    np.negative,
    np.sqrt,
    np.copysign,
    np.sin,
    np.cos,
)


@dataclass(frozen=True, eq=False)
class Recorded(NDArrayOperatorsMixin):
    """A value (N,) that is known when the tape is replayed: its row."""

    tape: "Tape"
    row: int

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **_: Any) -> Any:
        """What the arithmetic of `scalars` and numpy's functions call; their `out` is not needed: values are new."""
        if method != "__call__" or ufunc not in _ARITHMETIC:
            return NotImplemented  # a comparison, above all: what is decided by values cannot be replayed
        return self.tape.write(ufunc, inputs)

    def __bool__(self) -> bool:
        """Is not known yet: raises TypeError."""
        raise TypeError("a recorded value is known when the tape is replayed, and nothing can hang on it")


@dataclass(frozen=True)
class _Operation:
    """One value: the operation, the rows of its arguments, its row, and after how many others it can come."""

    ufunc: np.ufunc
    arguments: tuple[int, ...]
    row: int
    depth: int


class _Group(NamedTuple):
    """Operations of one kind that do not need each other: rows of their arguments, (k,) each, and of the results."""

    ufunc: np.ufunc
    first: np.ndarray
    second: np.ndarray | None
    results: slice


@dataclass(frozen=True)
class Stage:
    """A part of a program: where its inputs and outputs stand, and what is done in between."""

    inputs: slice
    groups: tuple[_Group, ...]
    outputs: np.ndarray


@dataclass(frozen=True)
class Program:
    """Stages that are replayed in their order; one may be replayed again before the next.

    constants: rows (c,) that are the same in all samples, the first ones. rows: how many there are. largest: group.
    """

    constants: np.ndarray
    stages: tuple[Stage, ...]
    rows: int
    largest: int

    def replay(self, samples: int) -> "TapeRun":
        """A replay for so many samples."""
        memory = np.empty((self.rows, samples))
        memory[: len(self.constants)] = self.constants[:, None]
        return TapeRun(self, memory, np.empty((2, self.largest, samples)))


@dataclass(frozen=True)
class TapeRun:
    """All values (rows, N) of a replay, and room for the arguments of a group."""

    program: Program
    memory: np.ndarray
    room: np.ndarray

    def run(self, stage: int, inputs: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
        """The outputs (k, N) of a stage for its inputs (i, N)."""
        part, memory = self.program.stages[stage], self.memory
        for row, values in zip(range(part.inputs.start, part.inputs.stop), inputs, strict=True):
            memory[row] = values
        first_operand, second_operand = self.room
        for ufunc, first, second, results in part.groups:
            count = results.stop - results.start  # "clip" below: NumPy needs no buffer, and no row is outside
            argument = memory.take(first, 0, first_operand[:count], "clip")
            if second is None:
                ufunc(argument, memory[results])
            else:
                ufunc(argument, memory.take(second, 0, second_operand[:count], "clip"), memory[results])
        return np.asarray(memory[part.outputs])


class Tape:
    """Records a program, stage by stage: `inputs`, arithmetic on them, `end_stage`, and `program` at the end."""

    def __init__(self) -> None:
        self._values = 0
        self._depths: dict[int, int] = {}
        self._constants: dict[str, tuple[int, float]] = {}
        self._inputs: list[int] = []
        self._operations: list[_Operation] = []
        self._stages: list[tuple[list[int], list[_Operation], list[int]]] = []

    def inputs(self, count: int) -> list[Scalar]:
        """Record so many inputs of the stage that begins or has begun."""
        rows = [self._new(0) for _ in range(count)]
        self._inputs += rows
        return [Recorded(self, row) for row in rows]  # type: ignore[misc]

    def write(self, ufunc: np.ufunc, values: Sequence[Any]) -> Recorded:
        """Record an operation on recorded values and floats."""
        arguments = tuple(self._row(value) for value in values)
        depth = 1 + max(self._depths[row] for row in arguments)
        row = self._new(depth)
        self._operations.append(_Operation(ufunc, arguments, row, depth))
        return Recorded(self, row)

    def end_stage(self, outputs: Sequence[Scalar]) -> None:
        """End the stage with what it gives."""
        self._stages.append((self._inputs, self._operations, [self._row(value) for value in outputs]))
        self._inputs, self._operations = [], []

    def program(self) -> Program:
        """What has been recorded, its rows put into the order of their groups: constants, then stage by stage."""
        place = {row: k for k, (row, _) in enumerate(self._constants.values())}
        stages: list[Stage] = []
        largest = 0
        for inputs, operations, outputs in self._stages:
            first = len(place)
            place.update((row, first + k) for k, row in enumerate(inputs))
            groups = []
            ordered = sorted(operations, key=_kind)
            for _, same in groupby(ordered, key=_kind):
                members, start = list(same), len(place)
                place.update((member.row, start + k) for k, member in enumerate(members))
                columns = zip(*(member.arguments for member in members), strict=True)
                first_rows, *others = (np.array([place[row] for row in rows]) for rows in columns)
                second_rows = others[0] if others else None
                groups.append(_Group(members[0].ufunc, first_rows, second_rows, slice(start, len(place))))
                largest = max(largest, len(members))
            given = np.array([place[row] for row in outputs], dtype=int)
            stages.append(Stage(slice(first, first + len(inputs)), tuple(groups), given))
        constants = np.array([value for _, value in self._constants.values()])
        return Program(constants, tuple(stages), len(place), largest)

    def _new(self, depth: int) -> int:
        self._depths[self._values] = depth
        self._values += 1
        return self._values - 1

    def _row(self, value: Any) -> int:
        """The row of a value: of its operation, or that of a constant."""
        if isinstance(value, Recorded):
            return value.row
        number = float(value)
        if number.hex() not in self._constants:  # tells 0 from -0
            self._constants[number.hex()] = self._new(0), number
        return self._constants[number.hex()][0]


class Reused(Generic[Made]):
    """What is made of a tape, once it has been asked for often enough."""

    def __init__(self) -> None:
        self._uses = 0
        self._made: Made | None = None

    def get(self, samples: int, make: Callable[[], Made]) -> Made | None:
        """For a block of so many samples; None where that is worked out faster without."""
        if not 1 < samples <= MEMORY.tape_samples:
            return None
        self._uses += 1
        if self._made is None and self._uses > MEMORY.tape_uses:
            self._made = make()
        return self._made


def _kind(operation: _Operation) -> tuple[int, str]:
    return operation.depth, operation.ufunc.__name__
