"""A table as a value: columns with the kind of their cells, independent of the medium."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, Literal

from bench.document.numbers import (
    change_between,
    is_poor,
    percent,
    pretty_unit,
    quantity_text,
    rounded_terms,
    value_and_std,
)
from bench.effects.display_names import spoken
from bench.identification.frame import data_frame

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
"""Kind of a column's cells: texts; sentences; names of effects, repeated ones blank; verdicts; quantities, with their
standard deviations, as relative deviations, or as values to the digits that these support; numbers of standard
deviations; shares, or signed changes; pairs of values before and after; numbers; units; terms of a grouping; shares of
the longest bar.
"""

Mark = Literal["", "strong", "weak", "poor"]
PLAIN: Mark = ""
RIGHT: frozenset[Kind] = frozenset({"deviation", "true", "sigma", "share", "change", "moved", "number"})


@dataclass(frozen=True)
class Column:
    """A header and its cells: None if unknown, an empty text for a blank cell.

    rank: order of omission if the table is too wide, the highest rank first; 0: never. format, unit: of numbers.
    """

    header: str
    cells: Sequence[Any]
    kind: Kind = "text"
    rank: int = 0
    format: str = ".6g"
    unit: str = ""

    @property
    def texts(self) -> list[str]:
        """The cells as plain text."""
        if self.kind == "effect":
            pairs = zip([None, *self.cells], self.cells, strict=False)
            return ["" if cell == last else spoken(cell) for last, cell in pairs]
        return ["" if cell == "" else "–" if cell is None else self._text(cell) for cell in self.cells]

    @property
    def poor(self) -> list[bool]:
        """Which cells are poorly determined; see `is_poor`."""
        return [self.kind == "deviation" and cell.std < inf and is_poor(cell) for cell in self.cells]

    def _text(self, cell: Any) -> str:
        """The text of a cell that is neither blank nor unknown, of any kind except "effect"."""
        number = f" {self.unit}" if self.unit else ""
        written: dict[Kind, Callable[[Any], str]] = {
            "unit": pretty_unit,
            "quantity": quantity_text,
            "deviation": lambda entry: percent(entry.relative_std) if 0.0 < entry.std < inf else "–",
            "true": lambda entry: value_and_std(entry.value, entry.std)[0],
            "sigma": lambda entry: f"{entry:+.1f} σ",
            "share": percent,
            "bar": percent,
            "change": lambda entry: percent(entry, signed=True),
            "moved": lambda entry: change_between(*entry),
            "number": lambda entry: f"{entry:{self.format}}{number}",
            "terms": lambda entry: " ".join(rounded_terms(list(entry))),
        }
        return written.get(self.kind, str)(cell)


@dataclass(frozen=True)
class Table:
    """Columns of the same length.

    marks: one per row: "strong" for the most important rows and totals, "weak" for secondary ones, "poor" for poorly
    determined ones; empty: all plain. ends: indices of rows that end a section.
    """

    columns: tuple[Column, ...]
    marks: tuple[Mark, ...] = ()
    ends: tuple[int, ...] = ()

    @property
    def mark_of_rows(self) -> tuple[Mark, ...]:
        """The mark of every row."""
        return self.marks or (PLAIN,) * max((len(column.cells) for column in self.columns[:1]), default=0)

    def to_dataframe(self) -> pd.DataFrame:
        """The table with unformatted numbers; a quantity takes two columns. Needs pandas."""
        columns: dict[str, list[Any]] = {}
        for column in self.columns:
            if column.kind == "quantity":
                name = column.header.partition(" ±")[0]
                for head, field in ((name, "value"), (f"std of {name}", "std")):
                    columns[head] = [getattr(cell, field, cell) for cell in column.cells]
            elif column.kind not in {"deviation", "bar"}:
                columns[column.header] = list(column.cells)
        return data_frame(columns)
