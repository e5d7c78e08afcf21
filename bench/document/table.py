"""A table as a value: columns that know what their cells are, whatever the medium."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, Literal

from bench.document.numbers import (
    change_between,
    effect_name,
    is_poor,
    percent,
    pretty_unit,
    quantity_text,
    rounded_terms,
    value_and_deviation,
)
from bench.identification.frame import data_frame
from bench.identification.result import Quantity

if TYPE_CHECKING:
    import pandas as pd

Kind = Literal[
    "text",
    "sentence",
    "effect",
    "verdict",
    "quantity",
    "deviation",
    "true",
    "sigma",
    "share",
    "change",
    "moved",
    "number",
    "unit",
    "terms",
    "bar",
]
"""What cells are: texts; sentences; names of effects, told once where they repeat; verdicts; quantities, their relative
deviation, or only their value to the digits that it supports; numbers of deviations; shares, unsigned or as a change;
pairs of values before and after; numbers; units; terms of a grouping; shares of the longest bar.
"""

Mark = Literal["", "strong", "weak", "poor"]
PLAIN: Mark = ""
RIGHT: frozenset[Kind] = frozenset({"deviation", "true", "sigma", "share", "change", "moved", "number"})


@dataclass(frozen=True)
class Column:
    """A header and its cells: None for what is not known, an empty text for what is not told.

    rank: when it may be left out where there is little room; 0: never, the highest rank goes first. format, unit: of
    numbers.
    """

    header: str
    cells: Sequence[Any]
    kind: Kind = "text"
    rank: int = 0
    format: str = ".6g"
    unit: str = ""

    @property
    def texts(self) -> list[str]:
        """The cells in plain letters."""
        if self.kind == "effect":
            before = [None, *self.cells]
            return [
                "" if one == last else effect_name(one) for last, one in zip(before, self.cells, strict=False)
            ]
        return ["" if one == "" else "–" if one is None else self._text(one) for one in self.cells]

    @property
    def poor(self) -> list[bool]:
        """Which cells say little, as their deviation is large."""
        return [self.kind == "deviation" and one.std < inf and is_poor(one) for one in self.cells]

    def _text(self, cell: Any) -> str:
        """One cell that is known, of any kind but the names of effects."""
        number = f" {self.unit}" if self.unit else ""
        written: dict[Kind, Callable[[Any], str]] = {
            "unit": pretty_unit,
            "quantity": quantity_text,
            "deviation": lambda one: percent(one.relative_std) if 0.0 < one.std < inf else "–",
            "true": lambda one: value_and_deviation(one.value, one.std)[0],
            "sigma": lambda one: f"{one:+.1f} σ",
            "share": percent,
            "bar": percent,
            "change": lambda one: percent(one, signed=True),
            "moved": lambda one: change_between(*one),
            "number": lambda one: f"{one:{self.format}}{number}",
            "terms": lambda one: " ".join(rounded_terms(list(one))),
        }
        return written.get(self.kind, str)(cell)


@dataclass(frozen=True)
class Table:
    """Columns of one length.

    marks: one a row: "strong" for what counts most or sums up, "weak" for what stands beside, "poor" for what says
    little; none: all plain. ends: rows below which a part ends.
    """

    columns: tuple[Column, ...]
    marks: tuple[Mark, ...] = ()
    ends: tuple[int, ...] = ()

    @property
    def mark_of_rows(self) -> tuple[Mark, ...]:
        """The mark of every row."""
        return self.marks or (PLAIN,) * len(self.columns[0].cells)

    def to_dataframe(self) -> pd.DataFrame:
        """The table with its numbers as they are; a quantity takes two columns. Needs pandas."""
        columns: dict[str, list[Any]] = {}
        for one in self.columns:
            if one.kind == "quantity":
                name = one.header.partition(" ±")[0]
                columns[name] = [cell.value if isinstance(cell, Quantity) else cell for cell in one.cells]
                columns[f"std of {name}"] = [
                    cell.std if isinstance(cell, Quantity) else cell for cell in one.cells
                ]
            elif one.kind not in {"deviation", "bar"}:
                columns[one.header] = list(one.cells)
        return data_frame(columns)
