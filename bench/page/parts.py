"""The parts of a page: frozen plain data, ready for JSON."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Literal

from bench.basics.versions import versions
from bench.document import table as document
from bench.document.table import RIGHT
from bench.document.typeset import typeset

Kind = Literal["", "right", "keep", "words", "small"]
Spec = Mapping[str, Any]
"""A chart for `assets/charts.js`: {label, height, x, panels}."""

KINDS: Mapping[str, Kind] = {
    "sentence": "words",
    "effect": "keep",
    "unit": "keep",
    "terms": "small",
    "quantity": "right",
}
MARKS = {"": "", "strong": "strong", "weak": "weak", "poor": "weak"}


@dataclass(frozen=True)
class PageColumn:
    """A table's column. kind: style of its cells, such as "right" for numbers, "words" for sentences."""

    header: str
    kind: Kind = ""


@dataclass(frozen=True)
class Cell:
    """A text in a table. kind: "poor", or "badge" with a verdict."""

    text: str
    kind: str = ""


@dataclass(frozen=True)
class PageRow:
    """A row of cells. kind: "strong" or "weak"."""

    cells: tuple[Cell, ...]
    kind: str = ""


@dataclass(frozen=True)
class PageTable:
    """aid: one line on how to read the table; folded: shown only on request; id: target of links."""

    title: str
    aid: str
    columns: tuple[PageColumn, ...]
    rows: tuple[PageRow, ...]
    folded: bool = False
    id: str = ""
    type: Literal["table"] = "table"


@dataclass(frozen=True)
class Items:
    """Sentences as a list."""

    title: str
    aid: str
    items: tuple[str, ...]
    folded: bool = False
    type: Literal["items"] = "items"


@dataclass(frozen=True)
class Text:
    """Paragraphs."""

    title: str
    paragraphs: tuple[str, ...]
    aid: str = ""
    type: Literal["text"] = "text"


@dataclass(frozen=True)
class Commands:
    """Lines for a terminal."""

    title: str
    aid: str
    lines: tuple[str, ...]
    type: Literal["commands"] = "commands"


@dataclass(frozen=True)
class PageChart:
    """One chart of a figure; title and aid are empty if the figure's are sufficient."""

    title: str
    aid: str
    spec: Spec


@dataclass(frozen=True)
class Linked:
    """A sentence followed by a link to a part of the page. to: the part's id, "" for no link.

    choose: options that a click selects in that part, by the name of their choice.
    """

    text: str
    link: str
    to: str
    choose: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Variant:
    """What a figure shows for one combination of choices. notes: sentences above the charts."""

    charts: tuple[PageChart, ...]
    notes: tuple[str | Linked, ...] = ()


@dataclass(frozen=True)
class Choice:
    """A selection in a figure, such as which motor. first: index of the initial option.

    together: label of the option that shows all of them side by side, over one axis; "" for none.
    """

    name: str
    options: tuple[str, ...]
    first: int = 0
    together: str = ""


@dataclass(frozen=True)
class Figure:
    """Charts for every combination of choices. wide: one chart in a row, otherwise several side by side.

    variants: by the indices of the options, as in "0|2", "" without choices; printed: keys of those that are printed.
    """

    title: str
    aid: str
    wide: bool
    choices: tuple[Choice, ...]
    variants: Mapping[str, Variant]
    printed: tuple[str, ...]
    type: Literal["figure"] = "figure"


@dataclass(frozen=True)
class RunsColumn:
    """A column of `Runs`. labels: if given, values are indices of these, by which runs are filtered; axis: its name in
    a chart's `pick`. kind: "share" for values shown in percent.
    """

    header: str
    values: tuple[float | int | str | None, ...]
    labels: tuple[str, ...] = ()
    axis: str = ""
    kind: Literal["", "share"] = ""


@dataclass(frozen=True)
class Runs:
    """Runs of a sweep. The first column: numbers; failed: reasons by number; command: shows the runs that follow."""

    title: str
    aid: str
    columns: tuple[RunsColumn, ...]
    failed: Mapping[str, str]
    command: str
    type: Literal["runs"] = "runs"


@dataclass(frozen=True)
class Mechanism:
    """The moving robot. recording: the option of the figure above whose time it shares; data: from `mechanism`."""

    title: str
    aid: str
    recording: str
    data: Mapping[str, Any]
    type: Literal["mechanism"] = "mechanism"


Part = PageTable | Items | Text | Commands | Figure | Runs | Mechanism


@dataclass(frozen=True)
class Section:
    """A part of the page. id: its address; short: its name in the contents, by default the title."""

    id: str
    title: str
    lead: str
    parts: tuple[Part, ...]
    short: str = ""


@dataclass(frozen=True)
class Tile:
    """A key number in large type."""

    label: str
    value: str
    note: str


def generator() -> str:
    """The program, with its version."""
    return f"parabench {dict(versions().packages)['parabench']}".rstrip()


def footer() -> str:
    """The program that wrote the page, and the date."""
    today = datetime.now(UTC).date()
    return f"Written by {generator()} on {today:%d %B %Y}. This file is complete: it asks for nothing from anywhere."


@dataclass(frozen=True)
class Page:
    """A whole page. verdict: sentences; facts: words under the title; doubtful: whether not to use the result."""

    title: str
    facts: tuple[str, ...]
    verdict: tuple[str, ...]
    tiles: tuple[Tile, ...]
    sections: tuple[Section, ...]
    doubtful: bool = False
    generator: str = field(default_factory=generator)
    footer: str = field(default_factory=footer)


def sentences_section(
    at: str, title: str, sentences: Iterable[str], lead: str = "", short: str = ""
) -> Section:
    """A section that contains only sentences. at: its address."""
    return Section(at, title, lead, (Items("", "", tuple(sentences)),), short)


def row(*cells: str | Cell, kind: str = "") -> PageRow:
    """A row of texts and cells."""
    return PageRow(tuple(cell if isinstance(cell, Cell) else Cell(cell) for cell in cells), kind)


def page_table(
    title: str,
    aid: str,
    heads: Mapping[str, Kind],
    rows: Iterable[PageRow | Sequence[str | Cell]],
    *,
    folded: bool = False,
) -> PageTable:
    """A table of texts and cells. heads: the kind of each column, by its header."""
    columns = tuple(PageColumn(header, kind) for header, kind in heads.items())
    cells = tuple(entry if isinstance(entry, PageRow) else row(*entry) for entry in rows)
    return PageTable(title, aid, columns, cells, folded)


def on_page(table: document.Table, title: str, aid: str, *, folded: bool = False) -> PageTable:
    """The table with its title and a line on how to read it."""
    columns = [column for column in table.columns if column.kind != "bar"]
    heads = tuple(
        PageColumn(column.header, "right" if column.kind in RIGHT else KINDS.get(column.kind, ""))
        for column in columns
    )
    rows = zip(table.mark_of_rows, *(_cells(column) for column in columns), strict=True)
    return PageTable(
        title, aid, heads, tuple(PageRow(tuple(cells), MARKS[mark]) for mark, *cells in rows), folded
    )


def _cells(column: document.Column) -> list[Cell]:
    if column.kind in {"verdict", "text"}:
        return [Cell(text, f"badge {text}" if column.kind == "verdict" else "") for text in column.texts]
    if column.kind == "terms":
        return [Cell(text.replace("- ", "− ") or "alone") for text in column.texts]
    return [
        Cell(typeset(text), "poor" if poor else "")
        for text, poor in zip(column.texts, column.poor, strict=True)
    ]
