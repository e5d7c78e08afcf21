"""A table in Markdown."""

from collections.abc import Sequence

from bench.document.table import Column, Table


def markdown(table: Table) -> str:
    """A table in Markdown, what counts most in bold; a bar in a cell stays a bar."""
    columns = [one for one in table.columns if one.kind != "bar"]
    strong = [mark == "strong" for mark in table.mark_of_rows]
    cells = [_cells(one) for one in columns]
    rows = [
        [f"**{first}**" if bold else first, *rest] for bold, first, *rest in zip(strong, *cells, strict=True)
    ]
    lines: list[Sequence[str]] = [[one.header for one in columns], ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def _cells(one: Column) -> list[str]:
    return [f"**! {text}**" if poor else text for text, poor in zip(one.texts, one.poor, strict=True)]
