"""How much of what a model leaves every term of the grammar would explain, at the fit's rate."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.discovery.factors import Factor
from bench.discovery.term import Term
from bench.discovery.variables import Place, Seen
from bench.identification.bounded import minimum_between
from bench.identification.partial_regression import PartialRegression

MOST_ROWS = 4000  # that are looked at: more add nothing to a first choice
TOGETHER = 256  # columns at a time
INVISIBLE = 1e-3  # share of a column that the model must leave of it
RIDGE = 1e-9  # added to a unit diagonal, so that parts that are alike can be solved
DEPENDENT = 1e-10  # of the largest singular value
DIGITS = 7  # of the share that a term explains
TOLERANCE = 1e-3  # relative, of a number


@dataclass(frozen=True)
class Screened:
    """A term, with its numbers at each motor, and the share of what is left, in squares, that it explains."""

    term: Term
    numbers: Mapping[int, tuple[float, ...]]
    share: float


class Known:
    """Values of the factors of some terms at one motor in few rows, computed once; of others, each time."""

    def __init__(self, seen: Seen, rows: np.ndarray, terms: Iterable[Term]) -> None:
        self._seen, self._rows = seen, rows
        every = {factor for term in terms for factor in term.factors}
        self._values = {factor: factor.values(seen)[rows] for factor in every}

    def values(self, factor: Factor) -> np.ndarray:
        """Its parts (M, parts)."""
        found = self._values.get(factor)
        return factor.values(self._seen)[self._rows] if found is None else found


class Left:
    """What a model and some terms leave at all motors, in few rows, and their columns there, orthonormal.

    basis (M, r), error (M,), weights (M,) motor by motor: the weights take torque to errors, and are
    zero at standstill.
    """

    def __init__(
        self,
        basis: Sequence[np.ndarray],
        error: Sequence[np.ndarray],
        weights: Sequence[np.ndarray],
        known: Sequence[Known],
    ) -> None:
        self._basis, self._error, self._weights, self._known = basis, error, weights, known
        self.squares = float(sum(one @ one for one in error))

    @property
    def motors(self) -> int:
        """How many there are."""
        return len(self._error)

    @property
    def rows(self) -> int:
        """Of all motors together."""
        return sum(map(len, self._error))

    def beside(self, one: "Screened", motors: Sequence[int] | None = None) -> "Left":
        """What is left with a term at every motor, or at some, each with a coefficient of its own."""
        some = range(self.motors) if motors is None else motors
        columns = [
            self._columns([one.term.with_numbers(one.numbers[j]) if one.numbers else one.term], j)
            for j in some
        ]
        size = columns[0].shape[1]
        rows = np.zeros((self.rows, len(some) * size))
        at = np.cumsum([0, *map(len, self._error)])
        for i, (j, column) in enumerate(zip(some, columns, strict=True)):
            rows[at[j] : at[j + 1], i * size : (i + 1) * size] = column
        own = np.concatenate(self._basis)
        lengths = np.linalg.norm(rows, axis=0)
        for _ in range(2):  # the second time for what rounding left of the first
            rows = rows - own @ (own.T @ rows)
        rows = rows[:, np.linalg.norm(rows, axis=0) > INVISIBLE * lengths]
        new = np.linalg.qr(rows)[0]
        error = np.concatenate(self._error)
        error = error - new @ (new.T @ error)
        basis = np.concatenate((own, new), axis=1)
        parts = at[1:-1]
        return Left(np.split(basis, parts), np.split(error, parts), self._weights, self._known)

    def explained(self, terms: Sequence[Term]) -> np.ndarray:
        """Sum of squares that each term explains at all motors together, (T,)."""
        found = np.zeros(len(terms))
        for parts in sorted({one.parts for one in terms}):
            chosen = [i for i, one in enumerate(terms) if one.parts == parts]
            size = max(1, TOGETHER // parts)
            for at in range(0, len(chosen), size):
                some = chosen[at : at + size]
                found[some] = self._together([terms[i] for i in some], range(self.motors))
        return found

    def explained_at(self, term: Term, motor: int) -> float:
        """The same for one term at one motor."""
        return float(self._together([term], [motor])[0])

    def fitted(self, term: Term) -> dict[int, tuple[float, ...]]:
        """Numbers of a term at every motor, each in turn where it explains most there."""
        return {j: self._numbers(term, j) for j in range(self.motors)} if term.numbers else {}

    def _numbers(self, term: Term, motor: int) -> tuple[float, ...]:
        for i, number in enumerate(term.numbers):

            def unexplained(value: float, i: int = i, term: Term = term) -> float:
                values = [one.value for one in term.numbers]
                values[i] = float(value)
                return -float(self._together([term.with_numbers(values)], [motor])[0])

            found, least = minimum_between(unexplained, number.low, number.high, TOLERANCE * abs(number.high))
            values = [one.value for one in term.numbers]
            if least < unexplained(values[i]):
                values[i] = found
            term = term.with_numbers(values)
        return tuple(one.value for one in term.numbers)

    def _together(self, terms: Sequence[Term], motors: Iterable[int]) -> np.ndarray:
        """The same for terms of as many parts each."""
        parts, count = terms[0].parts, len(terms)
        inner, across, towards, whole = [], [], [], []
        for j in motors:
            rows = self._columns(terms, j)
            own = rows.reshape(len(rows), count, parts)
            inner.append(np.einsum("mtp,mtq->tpq", own, own, optimize=True))
            across.append((self._basis[j].T @ rows).reshape(-1, count, parts))
            towards.append((self._error[j] @ rows).reshape(count, parts))
            whole.append(np.sqrt(np.einsum("tpp->tp", inner[-1])))
        size = len(inner) * parts
        right, lengths = np.concatenate(towards, axis=1), np.concatenate(whole, axis=1)
        within = np.concatenate(across, axis=2)  # (r, T, n p)
        normal = -np.einsum("rti,rtk->tik", within, within, optimize=True)
        for j, one in enumerate(inner):
            at = slice(j * parts, (j + 1) * parts)
            normal[:, at, at] += one
        left = np.sqrt(np.maximum(np.einsum("tii->ti", normal), 0.0))
        gone = left <= INVISIBLE * lengths
        left[gone] = np.inf
        scaled = normal / (left[:, :, None] * left[:, None, :])
        scaled[:, np.arange(size), np.arange(size)] = 1.0 + RIDGE
        right = right / left
        solved = np.linalg.solve(scaled, right[..., None])[..., 0]
        return np.asarray((right * solved).sum(axis=1))

    def _columns(self, terms: Sequence[Term], motor: int) -> np.ndarray:
        """Weighted columns (M, T p) of terms at a motor."""
        weights = self._weights[motor][:, None]
        found = np.empty((len(weights), len(terms), terms[0].parts))
        for i, term in enumerate(terms):
            column = weights
            for one in term.factors:
                column = column * self._known[motor].values(one)
            found[:, i] = column
        return found.reshape(len(found), -1)


def left_without(
    left: PartialRegression,
    known: Sequence[Known],
    rows: np.ndarray,
    without: Sequence[int] = (),
    values: Sequence[float] = (),
) -> Left:
    """What a solved model leaves of its currents in these rows of every motor, without some of its columns.

    without: their places among the model's; values: their coefficients. All are linearised about the same solution,
    that of the whole model, so that what is left without a part of it can be compared.
    """
    motors, out = range(len(left.columns)), list(without)
    own = np.concatenate([np.delete(left.columns[j][rows], out, axis=1) for j in motors])
    gone = [left.columns[j][rows][:, out] @ np.array(values, dtype=float) for j in motors]
    basis = _orthonormal(own)
    error = left.remainder[rows].T.reshape(-1) - np.concatenate(gone)
    error = error - basis @ (basis.T @ error)
    weights = [left.moving[rows, j] * left.weights[j] for j in motors]
    return Left(np.split(basis, len(motors)), np.split(error, len(motors)), weights, known)


def _orthonormal(columns: np.ndarray) -> np.ndarray:
    """Orthonormal columns of the same span."""
    lengths = np.linalg.norm(columns, axis=0)
    orthogonal, triangle = np.linalg.qr(columns / np.where(lengths > 0.0, lengths, 1.0))
    left, singular, _ = np.linalg.svd(triangle)
    return np.asarray(orthogonal @ left[:, singular > DEPENDENT * singular[0]])


def few_rows(samples: int) -> np.ndarray:
    """The rows of each motor that are looked at."""
    return np.arange(0, samples, -(-samples // MOST_ROWS))


def screened(
    left: Left, terms: Sequence[Term], most: int, but: Collection[object] = frozenset()
) -> list[Screened]:
    """The terms that explain most, each structure once, with their numbers adapted at every motor.

    but: structures that are not wanted.
    """
    explained = left.explained(terms)
    rounded = np.round(explained / left.squares, DIGITS)
    best: dict[object, int] = {}
    taken: set[float] = set()
    for i in sorted(range(len(terms)), key=lambda i: (-rounded[i], terms[i].strangeness)):
        structure = terms[i].structure
        if structure in but or structure in best or rounded[i] in taken:
            continue  # what explains as much to so many digits is the same in these data
        best[structure] = i
        taken.add(rounded[i])
        if len(best) == most:
            break
    return [
        Screened(terms[i], left.fitted(terms[i]), float(explained[i]) / left.squares) for i in best.values()
    ]


def at_place(one: Screened, place: Place) -> Term:
    """The term with the numbers that it has at a motor."""
    numbers = one.numbers.get(place.index)
    return one.term if numbers is None else one.term.with_numbers(numbers)
