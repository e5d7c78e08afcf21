"""How much of a model's residual every term of the grammar would explain, at the fit's rate."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.diagnosis.discovery.factors import Factor
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Place, Seen
from bench.identification.bounded import minimum_between
from bench.identification.partial_regression import PartialRegression
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Screened:
    """A term, with its constants at each motor, and the share of the squared residual that it explains."""

    term: Term
    numbers: Mapping[int, tuple[float, ...]]
    share: float


class Known:
    """Columns of some terms at one motor in few rows, computed once; those of others, each time.

    groups: terms that are computed together.
    """

    def __init__(self, seen: Seen, rows: np.ndarray, terms: Sequence[Term]) -> None:
        self._seen, self._rows = seen, rows
        self.groups = _groups(terms)
        self._terms, self._kept = terms, dict[int, np.ndarray]()
        self._may_keep = 8 * len(rows) * sum(term.parts for term in terms) <= TOLERANCES.memory.screened_bytes
        every = {factor for term in terms for factor in term.factors}
        self._values = {factor: factor.values(seen)[rows] for factor in every}

    def values(self, factor: Factor) -> np.ndarray:
        """Values (M, parts) of the factor's parts."""
        kept = self._values.get(factor)
        return factor.values(self._seen)[self._rows] if kept is None else kept

    def columns(self, terms: Sequence[Term]) -> np.ndarray:
        """Columns (M, T p) of terms of as many parts each."""
        matrix = np.empty((len(self._rows), len(terms), terms[0].parts))
        for i, term in enumerate(terms):
            first, *others = term.factors
            column = self.values(first)
            for factor in others:
                column = column * self.values(factor)
            matrix[:, i] = column
        return matrix.reshape(len(matrix), -1)

    def parts_of(self, group: int) -> int:
        """Number of parts of each term in a group."""
        return self._terms[self.groups[group][0]].parts

    def columns_of(self, group: int) -> np.ndarray:
        """Columns (M, T p) of the terms of one of the groups."""
        columns = self._kept.get(group)
        if columns is None:
            columns = self.columns([self._terms[i] for i in self.groups[group]])
            if self._may_keep:
                self._kept[group] = columns
        return columns


def _groups(terms: Sequence[Term]) -> list[list[int]]:
    """Terms that are computed together: not too many, all with as many parts."""
    groups = []
    for parts in sorted({term.parts for term in terms}):
        chosen = [i for i, term in enumerate(terms) if term.parts == parts]
        size = max(1, TOLERANCES.memory.screened_columns // parts)
        groups += [chosen[at : at + size] for at in range(0, len(chosen), size)]
    return groups


class Residual:
    """Residual of a model and some terms at all motors, in few rows, and their columns there, orthonormal.

    basis (M, r), error (M,), weights (M,) motor by motor: the weights convert torque to errors, zero at standstill.
    fewer: the residual without the last columns of the basis.
    """

    def __init__(
        self,
        basis: Sequence[np.ndarray],
        error: Sequence[np.ndarray],
        weights: Sequence[np.ndarray],
        known: Sequence[Known],
        fewer: "Residual | None" = None,
    ) -> None:
        self.basis, self.error, self.weights, self.known, self.fewer = basis, error, weights, known, fewer
        self.squares = float(sum(values @ values for values in error))

    @property
    def motors(self) -> int:
        """Their number."""
        return len(self.error)

    @property
    def rows(self) -> int:
        """Number of rows of all motors together."""
        return sum(map(len, self.error))

    def orthogonal_to(self, candidate: "Screened", motors: Sequence[int] | None = None) -> "Residual":
        """The residual with a term at every motor, or at some, each with a separate coefficient."""
        some = range(self.motors) if motors is None else motors
        columns = [
            self.known[j].columns(
                [candidate.term.with_numbers(candidate.numbers[j]) if candidate.numbers else candidate.term]
            )
            * self.weights[j][:, None]
            for j in some
        ]
        size = columns[0].shape[1]
        rows = np.zeros((self.rows, len(some) * size))
        at = np.cumsum([0, *map(len, self.error)])
        for i, (j, column) in enumerate(zip(some, columns, strict=True)):
            rows[at[j] : at[j + 1], i * size : (i + 1) * size] = column
        spanned = np.concatenate(self.basis)
        lengths = np.linalg.norm(rows, axis=0)
        for _ in range(2):  # the second time for the rounding errors of the first
            rows = rows - spanned @ (spanned.T @ rows)
        rows = rows[:, np.linalg.norm(rows, axis=0) > TOLERANCES.rank.visible_term * lengths]
        new = np.linalg.qr(rows)[0]
        error = np.concatenate(self.error)
        error = error - new @ (new.T @ error)
        basis = np.concatenate((spanned, new), axis=1)
        parts = at[1:-1]
        return Residual(np.split(basis, parts), np.split(error, parts), self.weights, self.known, self)

    def explained(self) -> np.ndarray:
        """Sum of squares that each of the known terms explains at all motors together, (T,)."""
        reductions = np.zeros(sum(map(len, self.known[0].groups)))
        for some, products in zip(self.known[0].groups, self.products, strict=True):
            reductions[some] = products.explained()
        return reductions

    def explained_at(self, term: Term, motor: int) -> float:
        """The same for one term at one motor."""
        columns = [self.known[motor].columns([term])]
        return float(self._products(columns, [motor], term.parts).explained()[0])

    @cached_property
    def products(self) -> "list[Products]":
        """Products of the known terms in their groups; updates those of the residual without the new columns."""
        every = range(self.motors)
        all_products = []
        for k in range(len(self.known[0].groups)):
            columns = [known.columns_of(k) for known in self.known]
            if self.fewer is None:
                all_products.append(self._products(columns, every, self.known[0].parts_of(k)))
            else:
                all_products.append(self._joined(self.fewer, self.fewer.products[k], columns))
        return all_products

    def _joined(self, before: "Residual", products: "Products", columns: Sequence[np.ndarray]) -> "Products":
        """Products with columns (M, T p) of some terms at every motor, from those of the smaller basis."""
        new = [values[:, before.basis[j].shape[1] :] for j, values in enumerate(self.basis)]
        along = [(values * self.weights[j][:, None]).T @ columns[j] for j, values in enumerate(new)]
        count = len(products.normal)
        within = np.concatenate(  # also without new columns
            [entry.reshape(len(entry), count, entry.shape[1] // count) for entry in along], axis=2
        )
        taken = sum(values.T @ before.error[j] for j, values in enumerate(new))
        return products.without(within, np.asarray(taken))

    def fitted(self, term: Term) -> dict[int, tuple[float, ...]]:
        """Constants of a term at every motor, each in turn where it explains most."""
        return {j: self._numbers(term, j) for j in range(self.motors)} if term.numbers else {}

    def _numbers(self, term: Term, motor: int) -> tuple[float, ...]:
        for i, number in enumerate(term.numbers):

            def unexplained(value: float, i: int = i, term: Term = term) -> float:
                values = [other.value for other in term.numbers]
                values[i] = float(value)
                return -self.explained_at(term.with_numbers(values), motor)

            optimum, least = minimum_between(
                unexplained, number.low, number.high, TOLERANCES.shapes.number_tolerance * abs(number.high)
            )
            values = [other.value for other in term.numbers]
            if least < unexplained(values[i]):
                values[i] = optimum
            term = term.with_numbers(values)
        return tuple(other.value for other in term.numbers)

    def _products(self, columns: Sequence[np.ndarray], motors: Sequence[int], parts: int) -> "Products":
        """Products of columns (M, T p) of terms of `parts` parts at some motors."""
        inner, across, towards, whole = [], [], [], []
        for j, column in zip(motors, columns, strict=True):
            rows = column * self.weights[j][:, None]
            blocks = rows.reshape(len(rows), -1, parts)
            count = blocks.shape[1]
            inner.append(np.einsum("mtp,mtq->tpq", blocks, blocks, optimize=True))
            across.append((self.basis[j].T @ rows).reshape(-1, count, parts))
            towards.append((self.error[j] @ rows).reshape(count, parts))
            whole.append(np.sqrt(np.einsum("tpp->tp", inner[-1])))
        right, lengths = np.concatenate(towards, axis=1), np.concatenate(whole, axis=1)
        size = len(inner) * parts
        normal = np.zeros((len(right), size, size))
        for j, entry in enumerate(inner):
            at = slice(j * parts, (j + 1) * parts)
            normal[:, at, at] = entry
        within = np.concatenate(across, axis=2)  # (r, T, n p)
        return Products(normal, right, lengths).without(within, np.zeros(len(within)))


@dataclass(frozen=True)
class Products:
    """Products of some terms: for each, inner products (T, q, q) of its columns, those with the residual (T, q),
    lengths (T, q).

    Except for lengths, after projecting out the model and other terms. q: the parts of a term at all motors.
    """

    normal: np.ndarray
    right: np.ndarray
    lengths: np.ndarray

    def without(self, within: np.ndarray, taken: np.ndarray) -> "Products":
        """The same without more orthonormal columns: their products (r, T, q), with the residual (r,)."""
        normal = self.normal - np.einsum("rti,rtk->tik", within, within, optimize=True)
        return Products(normal, self.right - np.einsum("r,rti->ti", taken, within), self.lengths)

    def explained(self) -> np.ndarray:
        """Sum of squares that each term explains, (T,)."""
        remaining = np.sqrt(np.maximum(np.einsum("tii->ti", self.normal), 0.0))
        remaining[remaining <= TOLERANCES.rank.visible_term * self.lengths] = np.inf
        scaled = self.normal / (remaining[:, :, None] * remaining[:, None, :])
        each = np.arange(remaining.shape[1])
        scaled[:, each, each] = 1.0 + TOLERANCES.rank.ridge_of_terms
        right = self.right / remaining
        solved = np.linalg.solve(scaled, right[..., None])[..., 0]
        return np.asarray((right * solved).sum(axis=1))


def residual_without(
    regression: PartialRegression,
    known: Sequence[Known],
    rows: np.ndarray,
    without: Sequence[int] = (),
    values: Sequence[float] = (),
) -> Residual:
    """The residual of a solved model's currents in these rows of every motor, without some of its columns.

    without: their indices among the model's; values: their coefficients. All are linearised about the same solution,
    that of the whole model, so that residuals without parts of it are comparable.
    """
    motors, out = range(len(regression.columns)), list(without)
    kept = np.concatenate([np.delete(regression.columns[j][rows], out, axis=1) for j in motors])
    gone = [regression.columns[j][rows][:, out] @ np.array(values, dtype=float) for j in motors]
    basis = _orthonormal(kept)
    error = regression.remainder[rows].T.reshape(-1) - np.concatenate(gone)
    error = error - basis @ (basis.T @ error)
    weights = [regression.moving[rows, j] * regression.weights[j] for j in motors]
    return Residual(np.split(basis, len(motors)), np.split(error, len(motors)), weights, known)


def _orthonormal(columns: np.ndarray) -> np.ndarray:
    """Orthonormal columns of the same span."""
    lengths = np.linalg.norm(columns, axis=0)
    orthogonal, triangle = np.linalg.qr(columns / np.where(lengths > 0.0, lengths, 1.0))
    vectors, singular, _ = np.linalg.svd(triangle)
    return np.asarray(orthogonal @ vectors[:, singular > TOLERANCES.rank.terms * singular[0]])


def few_rows(samples: int) -> np.ndarray:
    """The rows of each motor that are used."""
    return np.arange(0, samples, -(-samples // TOLERANCES.memory.screened_rows))


def screened(
    residual: Residual, terms: Sequence[Term], most: int, but: Collection[object] = frozenset()
) -> list[Screened]:
    """The known terms that explain most, each structure once, with constants adapted at every motor.

    but: excluded structures.
    """
    explained = residual.explained()
    rounded = np.round(explained / residual.squares, TOLERANCES.rank.digits)
    best: dict[object, int] = {}
    taken: set[float] = set()
    for i in sorted(range(len(terms)), key=lambda i: (-rounded[i], terms[i].strangeness)):
        structure = terms[i].structure
        if structure in but or structure in best or rounded[i] in taken:
            continue  # terms that explain equally much to these digits are the same in these data
        best[structure] = i
        taken.add(rounded[i])
        if len(best) == most:
            break
    return [
        Screened(terms[i], residual.fitted(terms[i]), float(explained[i]) / residual.squares)
        for i in best.values()
    ]


def at_place(candidate: Screened, place: Place) -> Term:
    """The term with its constants at a motor."""
    numbers = candidate.numbers.get(place.index)
    return candidate.term if numbers is None else candidate.term.with_numbers(numbers)
