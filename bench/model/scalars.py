"""Arithmetic on scalars: floats where all samples have the same, arrays (N,) where they differ.

What is zero or one by the robot's build - an axis along z, a planar mechanism, a leg that another leg's motor
does not move - is a float and folds away (0 x = 0, 1 x = x, 0 + x = x): structure costs no time and needs no
bookkeeping. Arrays are never changed once they are returned, so that results may share them.

Recorded values take the place of arrays, so that the model's functions write a tape, which is replayed on whole groups
of operations, for blocks of few samples. All values of a replay are the rows of one array; operations of the same kind
whose arguments are ready together are one call of NumPy. On a hundred samples a single operation is mostly the call
(W. Kahan's "vectorise across the other dimension"): in groups it costs a fifth. Every value comes from the same
operation on the same values, so that no bit changes.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from bench.model.bounds import BODIES, MEMORY

Scalar = float | np.ndarray
Rows = np.ndarray | list[Scalar]  # a scalar for each coordinate: an array (k, N), or k scalars
Vector = tuple[Scalar, Scalar, Scalar]
Matrix = tuple[Vector, Vector, Vector]  # by columns: the directions of a frame's axes


def constants(values: Iterable[float]) -> tuple[float, ...]:
    """Constants as floats, free of the rounding that keeps a zero or a one from being seen as such."""
    return tuple(_tidy(float(value)) for value in values)


def constant_vector(values: np.ndarray) -> Vector:
    """A constant (3,)."""
    x, y, z = constants(values)
    return x, y, z


def constant_matrix(values: np.ndarray) -> Matrix:
    """A constant (3, 3), by columns."""
    return constant_vector(values[:, 0]), constant_vector(values[:, 1]), constant_vector(values[:, 2])


def times(a: Scalar, b: Scalar) -> Scalar:
    """Product a b."""
    if isinstance(a, float):
        if a == 0.0:
            return 0.0
        if a == 1.0:
            return b
    if isinstance(b, float):
        if b == 0.0:
            return 0.0
        if b == 1.0:
            return a
    return a * b


def plus(a: Scalar, b: Scalar) -> Scalar:
    """Sum a + b."""
    if isinstance(a, float) and a == 0.0:
        return b
    if isinstance(b, float) and b == 0.0:
        return a
    return a + b


def minus(a: Scalar, b: Scalar) -> Scalar:
    """Difference a - b."""
    if isinstance(b, float) and b == 0.0:
        return a
    if isinstance(a, float) and a == 0.0:
        return -b
    return a - b


def plus_product(c: Scalar, a: Scalar, b: Scalar) -> Scalar:
    """c + a b, in the memory of the product where that is new."""
    product = times(a, b)
    if isinstance(product, float):
        return plus(c, product)
    if isinstance(c, float) and c == 0.0:
        return product
    if product is a or product is b:
        return c + product
    return np.add(c, product, out=product)


def minus_product(c: Scalar, a: Scalar, b: Scalar) -> Scalar:
    """c - a b, in the memory of the product where that is new."""
    product = times(a, b)
    if isinstance(product, float):
        return minus(c, product)
    if product is a or product is b:
        return minus(c, product)
    if isinstance(c, float) and c == 0.0:
        return np.negative(product, out=product)
    return np.subtract(c, product, out=product)


def dot(a: Iterable[Scalar], b: Iterable[Scalar]) -> Scalar:
    """Sum of the products of two sequences of the same length."""
    total: Scalar = 0.0
    for x, y in zip(a, b, strict=True):
        total = plus_product(total, x, y)
    return total


def add(a: Vector, b: Vector) -> Vector:
    """Vector a + b."""
    return plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2])


def subtract(a: Vector, b: Vector) -> Vector:
    """Vector a - b."""
    return minus(a[0], b[0]), minus(a[1], b[1]), minus(a[2], b[2])


def scaled(a: Vector, s: Scalar) -> Vector:
    """Vector s a."""
    return times(a[0], s), times(a[1], s), times(a[2], s)


def cross(a: Vector, b: Vector) -> Vector:
    """Vector a x b."""
    return (
        minus_product(times(a[1], b[2]), a[2], b[1]),
        minus_product(times(a[2], b[0]), a[0], b[2]),
        minus_product(times(a[0], b[1]), a[1], b[0]),
    )


def turned(rotation: Matrix, vector: Vector) -> Vector:
    """Matrix times vector."""
    x, y, z = rotation
    a, b, c = vector
    return (
        _three(x[0], y[0], z[0], a, b, c),
        _three(x[1], y[1], z[1], a, b, c),
        _three(x[2], y[2], z[2], a, b, c),
    )


def turned_back(rotation: Matrix, vector: Vector) -> Vector:
    """Transposed matrix times vector."""
    x, y, z = rotation
    return _three(*x, *vector), _three(*y, *vector), _three(*z, *vector)


def _three(x: Scalar, y: Scalar, z: Scalar, a: Scalar, b: Scalar, c: Scalar) -> Scalar:
    """x a + y b + z c."""
    return plus_product(plus_product(times(x, a), y, b), z, c)


def product(first: Matrix, second: Matrix) -> Matrix:
    """Matrix times matrix."""
    return turned(first, second[0]), turned(first, second[1]), turned(first, second[2])


def dense(scalars: Iterable[Scalar], samples: int) -> np.ndarray:
    """Scalars as an array (count, samples)."""
    listed = list(scalars)
    rows = np.empty((len(listed), samples))
    for row, scalar in zip(rows, listed, strict=True):
        row[:] = scalar
    return rows


def _tidy(value: float) -> float:
    for exact in (0.0, 1.0, -1.0):
        if abs(value - exact) < BODIES.tidy:
            return exact
    return value


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
