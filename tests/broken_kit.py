"""How a good dataset is spoilt: the registry of the broken ones and what edits files."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from bench.dataset.recording import write_table

CSV = "unloaded.csv"
PARQUET = "loaded.parquet"
Spoil = Callable[[Path], None]
BROKEN: dict[str, tuple[Spoil, tuple[str, ...]]] = {}


def broken(*expected: str) -> Callable[[Spoil], Spoil]:
    def register(spoil: Spoil) -> Spoil:
        BROKEN[spoil.__name__] = (spoil, expected)
        return spoil

    return register


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text, f"{old!r} is not in {path}"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def edit_lines(path: Path, change: Callable[[list[str]], None]) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    change(lines)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def set_cell(folder: Path, line: int, column: str, cell: str) -> None:
    """Replace one cell of the CSV; line 1 is the header."""

    def change(lines: list[str]) -> None:
        cells = lines[line - 1].split(",")
        cells[lines[0].split(",").index(column)] = cell
        lines[line - 1] = ",".join(cells)

    edit_lines(folder / CSV, change)


def read_columns(path: Path) -> dict[str, np.ndarray]:
    if path.suffix == ".parquet":
        table = pq.read_table(path)
        return {name: table[name].to_numpy().copy() for name in table.column_names}
    lines = path.read_text().splitlines()
    values = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), values.T.copy(), strict=True))


def change_column(
    folder: Path, column: str, change: Callable[[np.ndarray], np.ndarray], file: str = CSV
) -> None:
    columns = read_columns(folder / file)
    columns[column] = change(columns[column])
    write_table(folder / file, columns)
