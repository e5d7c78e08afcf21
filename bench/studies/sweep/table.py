"""The table of a sweep: one Parquet file with a row for each run."""

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.studies.sweep.journal import Journal, Row

BATCH = 1000  # rows in memory at once
FIRST = ("run", "status", "reason", "scenario", "seed")
LAST = ("commit", "version.")


def write_table(journal: Journal, path: Path, axes: Sequence[str], metadata: Mapping[str, str]) -> None:
    """Write all rows by number. The same rows give the same file to the last bit, in any order of arrival.

    Columns: those of every run, the axes, then metrics and other settings by name, and versions last.
    """
    kinds: dict[str, set[type]] = {}
    for row in journal.rows():
        for name, value in row.items():
            kinds.setdefault(name, set()).add(type(value))
    schema = pa.schema(
        [pa.field(name, _type(kinds[name])) for name in _ordered(kinds, axes)],
        metadata={key.encode(): value.encode() for key, value in metadata.items()},
    )
    with atomic_path(path) as partial, pq.ParquetWriter(partial, schema, compression="zstd") as writer:
        rows = journal.rows()
        while batch := list(islice(rows, BATCH)):
            columns = {
                field.name: [_cell(row.get(field.name), field.type) for row in batch] for field in schema
            }
            writer.write_table(pa.table(columns, schema=schema))


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write rows that may have different columns, whole or not at all; missing values are None."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns: dict[str, list[Any]] = {name: [row.get(name) for row in rows] for name in names}
    with atomic_path(path) as partial:
        pq.write_table(pa.table(columns), partial, compression="zstd")


def read_table(path: Path, columns: Sequence[str] | None = None) -> dict[str, list[Any]]:
    """Columns by name. Raises BenchError if the table cannot be read or has no such column."""
    try:
        known = pq.read_schema(path).names
    except (OSError, pa.ArrowInvalid) as error:
        raise BenchError(
            f"{path}: cannot be read as a Parquet table: {str(error).splitlines()[0]}"
        ) from error
    for name in columns or ():
        if name not in known:
            near = ", ".join(get_close_matches(name, known, 3))
            raise BenchError(f"{path}: no column {name!r}" + (f"; did you mean {near}?" if near else ""))
    table: dict[str, list[Any]] = pq.read_table(path, columns=list(columns) if columns else None).to_pydict()
    return table


def column_names(path: Path) -> list[str]:
    """Names of all columns."""
    return list(pq.read_schema(path).names)


def _ordered(kinds: Iterable[str], axes: Sequence[str]) -> list[str]:
    def rank(name: str) -> tuple[int, int, str]:
        if name in FIRST:
            return 0, FIRST.index(name), ""
        if name in axes:
            return 1, list(axes).index(name), ""
        return (3 if name.startswith(LAST) else 2), 0, name

    return sorted(kinds, key=rank)


def _type(kinds: set[type]) -> pa.DataType:
    known = kinds - {type(None)}
    for numbers, kind in (({bool}, pa.bool_()), ({int}, pa.int64()), ({int, float}, pa.float64())):
        if known and known <= numbers:
            return kind
    return pa.string()


def _cell(value: Any, kind: pa.DataType) -> Any:
    convert = {pa.float64(): float, pa.string(): str}.get(kind)
    return value if value is None or convert is None else convert(value)
