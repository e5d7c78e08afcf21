"""Solve the loop closures for the passive joints, leg by leg, for all samples at once.

The rows are the equations of the loops, the columns the passive velocities. Householder reflections eliminate one
column after the other, first those in the fewest equations (the joints of a leg), the platform's last: structural zeros
are never computed. Reflections need no pivoting and also solve more equations than unknowns (a planar loop in space is
redundant), by least squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.model.scalars import Scalar, dot, minus, minus_product, plus_product, times

Row = dict[int, Scalar]  # by column; absent entries are zero


@dataclass(frozen=True)
class _Reflection:
    """I - scale w w' on the named rows; w is 1 on the first and `tail` on the others."""

    rows: tuple[int, ...]
    tail: tuple[Scalar, ...]
    scale: Scalar

    def apply(self, values: Sequence[Scalar]) -> list[Scalar] | None:
        """The reflected values of the rows; None where all are zero."""
        head, *rest = values
        along = head
        for w, value in zip(self.tail, rest, strict=True):
            along = plus_product(along, w, value)
        step = times(self.scale, along)
        if isinstance(step, float) and step == 0.0:
            return None
        return [
            minus(head, step),
            *(minus_product(value, step, w) for w, value in zip(self.tail, rest, strict=True)),
        ]


@dataclass(frozen=True)
class Elimination:
    """Rows reduced to triangular form: for every column its reflection, its row and one over its pivot."""

    columns: tuple[int, ...]
    reflections: tuple[_Reflection | None, ...]
    rows: tuple[tuple[int, Row], ...]
    inverse_pivots: tuple[Scalar, ...]

    def solve(self, right: Sequence[Scalar]) -> dict[int, Scalar]:
        """The unknowns by column, for the right side of every row."""
        values = list(right)
        for reflection in self.reflections:
            if reflection is None:
                continue
            reflected = reflection.apply([values[i] for i in reflection.rows])
            if reflected is not None:
                for i, value in zip(reflection.rows, reflected, strict=True):
                    values[i] = value
        unknowns: dict[int, Scalar] = {}
        for column, (i, row), inverse in zip(
            reversed(self.columns), reversed(self.rows), reversed(self.inverse_pivots), strict=True
        ):
            rest = values[i]
            for other, factor in row.items():
                rest = minus_product(rest, factor, unknowns[other])
            unknowns[column] = times(rest, inverse)
        return unknowns


def elimination_order(rows: Sequence[Row]) -> tuple[int, ...]:
    """The columns, first those in the fewest rows."""
    count: dict[int, int] = {}
    for row in rows:
        for column in row:
            count[column] = count.get(column, 0) + 1
    return tuple(sorted(count, key=lambda column: (count[column], column)))


def eliminate(rows: Sequence[Row]) -> Elimination:
    """Reduce the equations.

    A dependent column gives infinite or NaN unknowns at the samples concerned; a column with no remaining equation
    raises numpy.linalg.LinAlgError.
    """
    remaining = {i: dict(row) for i, row in enumerate(rows)}
    columns = elimination_order(rows)
    reflections, pivots, inverse_pivots = [], [], []
    for column in columns:
        used = [i for i, row in remaining.items() if column in row]
        if not used:
            raise np.linalg.LinAlgError(f"column {column} is not determined")
        entries = [remaining[i].pop(column) for i in used]
        reflection, pivot = _reflection(used, entries)
        if reflection is not None:
            for other in sorted({c for i in used for c in remaining[i]}):
                reflected = reflection.apply([remaining[i].get(other, 0.0) for i in used])
                if reflected is None:
                    continue
                for i, value in zip(used, reflected, strict=True):
                    remaining[i][other] = value
        reflections.append(reflection)
        pivots.append((used[0], remaining.pop(used[0])))
        inverse_pivots.append(1.0 / pivot)
    return Elimination(columns, tuple(reflections), tuple(pivots), tuple(inverse_pivots))


def _reflection(rows: list[int], entries: list[Scalar]) -> tuple[_Reflection | None, Scalar]:
    """The reflection that zeroes all entries but the first, and the value there."""
    if len(rows) == 1:
        return None, entries[0]
    head, rest = entries[0], entries[1:]
    pivot = -np.copysign(np.sqrt(dot(entries, entries)), head)
    lead = head - pivot
    inverse = 1.0 / lead
    return _Reflection(tuple(rows), tuple(times(value, inverse) for value in rest), -lead / pivot), pivot
