"""Tables whose columns give way where a terminal is narrow, instead of being cut to pieces."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from rich import box
from rich.cells import cell_len
from rich.table import Table

GAPS = (2, 1)  # blanks between columns: the wider where there is room


@dataclass(frozen=True)
class Column:
    """One column: its cells, and when it may be left out (rank 0: never; the highest rank goes first)."""

    header: str
    cells: Sequence[str]
    justify: Literal["left", "right"] = "left"
    rank: int = 0
    style: str = ""

    @property
    def width(self) -> int:
        """Columns of the terminal that the widest cell takes."""
        return max(cell_len(text) for text in (self.header, *self.cells))


@dataclass(frozen=True)
class Fit:
    """Which columns stay, the gap between them, and the width that is left over (negative: too wide)."""

    columns: tuple[Column, ...]
    gap: int
    room: int


def fit_columns(columns: Sequence[Column], width: int, gaps: Sequence[int] = GAPS) -> Fit:
    """Narrow the gaps, then leave out columns of the highest rank, until all fit into `width`."""
    kept = list(columns)
    while True:
        total = sum(column.width for column in kept)
        gap = next((gap for gap in gaps if total + gap * (len(kept) - 1) <= width), gaps[-1])
        room = width - total - gap * (len(kept) - 1)
        last = max(kept, key=lambda column: column.rank)
        if room >= 0 or last.rank == 0:
            return Fit(tuple(kept), gap, room)
        kept = [column for column in kept if column.rank < last.rank]


def table_of(
    columns: Sequence[Column],
    width: int,
    *,
    row_styles: Sequence[str] | None = None,
    section_ends: Sequence[int] = (),
    gaps: Sequence[int] = GAPS,
) -> Table:
    """A table at most `width` wide, or as near as its columns of rank 0 allow; those are then folded.

    row_styles: one style a row. section_ends: rows after which a blank line stands. gaps: blanks
    between columns, the wider where there is room.
    """
    fit = fit_columns(columns, width, gaps)
    table = Table(
        box=box.SIMPLE_HEAD,
        pad_edge=False,
        padding=(0, fit.gap - 1, 0, 0),  # the box itself has one blank between columns
        header_style="dim",
        show_edge=False,
    )
    for column in fit.columns:
        table.add_column(
            column.header, justify=column.justify, style=column.style, no_wrap=fit.room >= 0, overflow="fold"
        )
    for row, cells in enumerate(zip(*(column.cells for column in fit.columns), strict=True)):
        style = row_styles[row] if row_styles else None
        table.add_row(*cells, style=style, end_section=row in section_ends)
    return table


def aligned_pair(left: Sequence[str], right: Sequence[str], between: str) -> list[str]:
    """Texts "left between right" that stand under each other at `between`."""
    first, second = max(map(len, left), default=0), max(map(len, right), default=0)
    return [f"{a:>{first}}{between}{b:<{second}}" for a, b in zip(left, right, strict=True)]
