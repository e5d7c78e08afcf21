"""A table in a terminal: in a narrow one, whole columns are omitted rather than cells cut."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import rich.table
from rich import box
from rich.cells import cell_len
from rich.text import Text

from bench.basics.plural import plural
from bench.document.layout import TEXT
from bench.document.numbers import GIVEN, quantity_parts, rounded_terms
from bench.document.table import RIGHT, Column, Table
from bench.identification.result import Quantity

EIGHTHS = " ▏▎▍▌▋▊▉"
POOR_STYLE = "yellow"
STYLES = {"": "", "strong": "bold", "weak": "dim", "poor": POOR_STYLE}


@dataclass(frozen=True)
class Strip:
    """A printed column: its texts, and the order of its omission (rank 0: never; the highest rank first).

    folds: whether this column, and not the others, wraps if the table is still too wide.
    """

    header: str
    cells: Sequence[str]
    justify: Literal["left", "right"] = "left"
    rank: int = 0
    style: str = ""
    folds: bool = False

    @property
    def width(self) -> int:
        """Terminal columns of the widest cell."""
        return max(cell_len(text) for text in (self.header, *self.cells))


@dataclass(frozen=True)
class Fit:
    """The remaining strips, the gap between them, and the unused width (negative: too wide)."""

    strips: tuple[Strip, ...]
    gap: int
    room: int


def fit_strips(strips: Sequence[Strip], width: int) -> Fit:
    """Narrow the gaps, then omit the strips of the highest rank, until all fit into `width` or only rank 0 remains."""
    fitting, gaps = list(strips), TEXT.gaps
    while fitting:
        total = sum(strip.width for strip in fitting)
        gap = next((gap for gap in gaps if total + gap * (len(fitting) - 1) <= width), gaps[-1])
        room = width - total - gap * (len(fitting) - 1)
        last = max(fitting, key=lambda strip: strip.rank)
        if room >= 0 or last.rank == 0:
            return Fit(tuple(fitting), gap, room)
        fitting = [strip for strip in fitting if strip.rank < last.rank]
    return Fit((), gaps[0], width)


def printed(table: Table, width: int = TEXT.width) -> rich.table.Table:
    """A table at most `width` wide; if its columns of rank 0 are wider, they wrap."""
    strips = [_strip(column) for column in table.columns if column.kind not in {"bar", "terms"}]
    for column in table.columns:
        if column.kind == "bar":
            room = width - sum(strip.width for strip in strips) - 2 * len(strips)
            length = max(min(room, TEXT.bar), TEXT.least_bar)
            bars = [bar(share, length) for share in column.cells]
            strips.append(Strip(column.header, bars, rank=column.rank))
        elif column.kind == "terms":
            fit = fit_strips(strips, width)
            room = fit.room - fit.gap
            if room >= TEXT.terms and any(column.cells):
                terms = [shortened(cell, room) for cell in column.cells]
                strips.append(Strip(column.header, terms, style="dim"))
    return _rich(fit_strips(strips, width), table)


def _rich(fit: Fit, table: Table) -> rich.table.Table:
    grid = rich.table.Table(
        box=box.SIMPLE_HEAD,
        pad_edge=False,
        padding=(0, fit.gap - 1, 0, 0),  # the box adds one blank between columns
        header_style="dim",
        show_edge=False,
    )
    if not fit.strips:
        return grid
    folds = any(strip.folds for strip in fit.strips)
    for strip in fit.strips:
        whole = fit.room >= 0 or (folds and not strip.folds)
        grid.add_column(
            Text(strip.header), justify=strip.justify, style=strip.style, no_wrap=whole, overflow="fold"
        )
    rows = zip(table.mark_of_rows, *(part.cells for part in fit.strips), strict=True)
    for row, (mark, *cells) in enumerate(rows):
        grid.add_row(*map(Text, cells), style=STYLES[mark], end_section=row in table.ends)
    return grid


def _strip(column: Column) -> Strip:
    texts = column.texts
    if column.kind == "quantity":
        texts = _aligned(column)
    if column.kind == "deviation":
        texts = [f"{'! ' if poor else ''}{text}" for text, poor in zip(texts, column.poor, strict=True)]
    justify: Literal["left", "right"] = "right" if column.kind in RIGHT else "left"
    return Strip(column.header, texts, justify, column.rank, folds=column.kind == "sentence")


def _aligned(column: Column) -> list[str]:
    """Values and standard deviations, aligned at the ± sign; undetermined ones as their text."""
    pairs = [quantity_parts(cell) if isinstance(cell, Quantity) else None for cell in column.cells]
    first = max((len(pair[0]) for pair in pairs if pair), default=0)
    second = max((len(pair[1]) for pair in pairs if pair), default=0)
    return [
        f"{pair[0]:>{first}}{'   ' if pair[1] == GIVEN else ' ± '}{pair[1]:<{second}}" if pair else text
        for text, pair in zip(column.texts, pairs, strict=True)
    ]


def bar(share: float, length: int) -> str:
    """A bar of a share between 0 and 1 of `length` columns, to an eighth of a column, which is also the shortest."""
    eighths = max(round(8 * length * min(share, 1.0)), 1) if share > 0.0 else 1  # also for NaN
    return "█" * (eighths // 8) + EIGHTHS[eighths % 8].strip()


def shortened(terms: Sequence[str], room: int) -> str:
    """As many whole terms as fit into `room`, and the number of omitted ones."""
    terms = rounded_terms(list(terms))
    for count in range(len(terms), 0, -1):
        rest = len(terms) - count
        for ending in (f" … {rest} more", " …") if rest else ("",):
            text = " ".join(terms[:count]) + ending
            if len(text) <= room:
                return text
    return plural(len(terms), "more term") if terms else ""
