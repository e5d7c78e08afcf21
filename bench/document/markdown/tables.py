"""A table in Markdown."""

from collections.abc import Iterable, Sequence

from bench.document.table import Column, Table

BAR = "\\|"


def markdown(table: Table) -> str:
    """A table in Markdown, what counts most in bold; a bar in a cell stays a bar."""
    columns = [column for column in table.columns if column.kind != "bar"]
    strong = [mark == "strong" for mark in table.mark_of_rows]
    cells = [_cells(column) for column in columns]
    rows = [
        [f"**{first}**" if bold else first, *rest] for bold, first, *rest in zip(strong, *cells, strict=True)
    ]
    return rows_in_markdown([column.header for column in columns], rows)


def rows_in_markdown(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Heads and rows of cells as a table in Markdown; a bar in a cell stays a bar."""
    lines: list[Sequence[object]] = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(str(cell).replace('|', BAR) for cell in line)} |" for line in lines)


def _cells(column: Column) -> list[str]:
    return [f"**! {text}**" if poor else text for text, poor in zip(column.texts, column.poor, strict=True)]
