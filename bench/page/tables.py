"""A table of the document on the page."""

from collections.abc import Mapping

from bench.document import table as document
from bench.document.table import RIGHT
from bench.document.typeset import typeset
from bench.page.parts import Cell, Kind, PageColumn, PageRow, PageTable

KINDS: Mapping[str, Kind] = {
    "sentence": "words",
    "effect": "keep",
    "unit": "keep",
    "terms": "small",
    "quantity": "right",
}
MARKS = {"": "", "strong": "strong", "weak": "weak", "poor": "weak"}


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
    if column.kind == "verdict":
        return [Cell(text, f"badge {text}") for text in column.texts]
    if column.kind == "text":
        return [Cell(text) for text in column.texts]
    if column.kind == "terms":
        return [Cell(text.replace("- ", "− ") or "alone") for text in column.texts]
    return [
        Cell(typeset(text), "poor" if poor else "")
        for text, poor in zip(column.texts, column.poor, strict=True)
    ]
