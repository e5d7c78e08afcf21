"""Read a CSV or Parquet file into named columns of numbers, and name rows as a user sees them.

CSV: UTF-8 with or without a byte order mark, one header line, values separated by comma, semicolon or tab; with
semicolon or tab, decimal commas are allowed. Blank lines are skipped. Parquet: flat columns of numbers.
"""

import io
import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.csv as pacsv

from bench.basics.errors import BenchError
from bench.basics.files.csv_text import CsvText, split_csv
from bench.basics.files.recording_fault import RecordingFaultError, Remedy
from bench.basics.files.toml_input import one_line

SUFFIXES = (".csv", ".parquet")
BLOCK = 1 << 26  # bytes of a text that are read at once
HUGE = 1e100  # a larger value is not a measurement, and its square may overflow
Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FileTable:
    """The columns of one file, or of a part of it.

    `text` is the CSV text, None for other files; `first_row` is the file's row (0 is the first) at which the part
    begins; `sources` maps columns to their names in the file, if these differ.
    """

    path: Path
    data: pa.Table
    text: CsvText | None
    first_row: int = 0
    sources: Mapping[str, str] = field(default_factory=dict)

    @property
    def columns(self) -> list[str]:
        """Column names in the order of the file."""
        return list(self.data.column_names)

    def row_name(self, row: int) -> str:
        """A row (0 is the first) as the user sees it: "line 2" of a CSV, "row 0" of a Parquet file."""
        row += self.first_row
        return f"row {row}" if self.text is None else f"line {self.text.line(row)}"

    def place(self, column: str, row: int | None = None) -> str:
        """A place for a message: file, column and, if given, row."""
        source = self.sources.get(column, column)
        named = column if source == column else f"{column} ({source!r} of the log)"
        where = "" if row is None else f", {self.row_name(row)}"
        return f"{self.path}: column {named}{where}"

    def is_plain(self, column: str) -> bool:
        """Whether the column contains only numbers or booleans, and empty cells."""
        kind = self.data.schema.field(column).type
        return _is_numeric(kind) or bool(pa.types.is_boolean(kind))

    def cells(self, column: str) -> list[str]:
        """The texts of a column's cells."""
        if self.text is None:
            return [str(value) for value in self.data[column].to_pylist()]
        rows = range(self.first_row, self.first_row + self.data.num_rows)
        return self.text.cells(self.columns.index(column), rows)

    def numbers(self, column: str) -> Array:
        """The column (N,) as floats, empty cells as NaN, true as 1.

        Errors: BenchError that names the row of a text, or the type of a column without numbers.
        """
        kind = self.data.schema.field(column).type
        if self.is_plain(column):
            return np.concatenate([np.zeros(0), *map(_floats, self.data[column].cast(pa.float64()).chunks)])
        if self.text is None:
            raise BenchError(f"{self.path}: column {column}: holds {kind}, not numbers")
        index = self.columns.index(column)
        rows = range(self.first_row, self.first_row + self.data.num_rows)
        if (first := self.text.first_text(index, rows)) is None:
            return np.array(self.text.floats(index, rows))
        row, cell = first
        if cell == self.text.names[index]:
            raise BenchError(
                f"{self.path}: line {self.text.line(row)}: names the columns once more: two logs were joined there; "
                "put each into a file of its own"
            )
        raise BenchError(f"{self.place(column, row - self.first_row)}: {cell!r} is not a number")

    def stamps(self) -> Array:
        """The time column (N,), with NaN for cells that are not numbers, to choose rows before they are checked."""
        kind = self.data.schema.field("time").type
        if self.is_plain("time") or self.text is None:
            return self.numbers("time") if _is_numeric(kind) else np.full(self.data.num_rows, np.nan)
        rows = range(self.first_row, self.first_row + self.data.num_rows)
        return np.array(self.text.floats(self.columns.index("time"), rows, otherwise=float("nan")))

    def finite(
        self, column: str, cure: Callable[[npt.NDArray[np.intp]], tuple[str, Remedy]] | None = None
    ) -> Array:
        """The column (N,) as floats; RecordingFaultError that names the first row that is empty, NaN, infinite or
        above HUGE.

        cure: from the indices of these rows, the cure in words and as a code.
        """
        if pa.types.is_boolean(kind := self.data.schema.field(column).type):
            raise BenchError(f"{self.path}: column {column}: holds {kind}, not numbers")
        values = self.numbers(column)
        bad = np.flatnonzero(~(np.abs(values) < HUGE))
        if bad.size:
            row = int(bad[0])
            more = f" (and {bad.size - 1} more rows)" if bad.size > 1 else ""
            what = self._what_stands(column, row, values[row])
            helps, remedy = ("", None) if cure is None else cure(bad)
            raise RecordingFaultError(
                f"{self.place(column, row)}: {what}{more}",
                f"; {helps}" if helps else "",
                remedy,
                column=column,
            )
        return values

    def _what_stands(self, column: str, row: int, value: float) -> str:
        source = self.sources.get(column, column)
        if self.text is None or source not in self.text.names:
            return "is empty" if not self.data[column][row].is_valid else f"is {value}"
        cell = self.text.cell(self.first_row + row, self.text.names.index(source))
        return f"is {cell!r}, which is no measurement" if cell else "is empty"


def _floats(chunk: pa.Array) -> Array:
    """A chunk of floats (N,), empty cells as NaN; without `to_numpy`, which imports pandas."""
    if chunk.null_count == len(chunk):
        return np.full(len(chunk), np.nan)
    values = np.frombuffer(chunk.buffers()[1], count=len(chunk), offset=8 * chunk.offset)
    if not chunk.null_count:
        return values
    return np.where(np.from_dlpack(chunk.is_null().cast(pa.uint8())), np.nan, values)


def _is_numeric(kind: pa.DataType) -> bool:
    tests = (pa.types.is_floating, pa.types.is_integer, pa.types.is_decimal, pa.types.is_null)
    return any(test(kind) for test in tests)


def read_table(path: Path) -> FileTable:
    """The table in the file `path`, CSV or Parquet by its suffix.

    Errors: BenchError, one line, if the file is missing, empty, truncated, of another kind than its suffix, has no
    header or no rows, a column twice, or a line (which is named) with too few or too many values.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise BenchError(f"{path}: neither a .csv nor a .parquet file")
    try:
        if path.stat().st_size == 0:
            raise BenchError(f"{path}: the file is empty")
        csv = suffix == ".csv"
        return table_of(split_csv(path, path.read_bytes())) if csv else _checked(_read_parquet(path))
    except OSError as error:
        raise BenchError(f"{path}: cannot be read: {error.strerror or one_line(error)}") from error


def _checked(table: FileTable) -> FileTable:
    path = table.path
    for name, count in Counter(table.columns).items():
        if name and count > 1:
            raise BenchError(f"{path}: column {name}: occurs {count} times")
    if table.data.num_rows == 0:
        raise BenchError(f"{path}: has a header but no rows")
    return table


def release_tables() -> None:
    """Return the memory of released tables to the system, which pyarrow would otherwise keep."""
    pa.default_memory_pool().release_unused()


def table_of(text: CsvText) -> FileTable:
    """The table in a text.

    Errors: BenchError, one line, for no rows, a column twice, or a line with too few or too many values.
    """
    path = text.path
    if not re.search(r"[^ \t\n\r\v\f]", text.body):
        raise BenchError(f"{path}: has a header but no rows")
    try:
        return _checked(FileTable(path, _cells(text), text))
    except pa.ArrowInvalid as error:
        raise BenchError(f"{path}: {text.ragged() or one_line(error)}") from error


def _cells(text: CsvText) -> pa.Table:
    """The cells of a text; the type of a column follows from all of its rows.

    A large text is read in blocks to save memory. If a later block does not match the types of the first one, it is
    read in one block.
    """
    if len(text.body) > BLOCK:
        try:
            return _parsed(text, _Encoded(text.body), BLOCK).combine_chunks()
        except pa.ArrowInvalid:
            pass
    body = text.body.encode()
    return _parsed(text, io.BytesIO(body), len(body) + 1)


def _parsed(text: CsvText, body: io.IOBase, block: int) -> pa.Table:
    options: dict[str, Any] = {
        "read_options": pacsv.ReadOptions(column_names=text.names, block_size=block),
        "parse_options": pacsv.ParseOptions(delimiter=text.delimiter),
        "convert_options": pacsv.ConvertOptions(decimal_point="," if text.decimal_comma else "."),
    }
    return pacsv.read_csv(body, **options)


class _Encoded(io.RawIOBase):
    """A stream that encodes a text while it is read, so that memory does not hold it twice."""

    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0

    def readable(self) -> bool:
        return True

    def read(self, size: int = -1) -> bytes:
        """Read at most `size` bytes (a character takes up to four of them), or at least one character."""
        end = len(self._text) if size < 0 else self._at + max(size // 4, 1)
        part, self._at = self._text[self._at : end], end
        return part.encode()


def _read_parquet(path: Path) -> FileTable:
    import pyarrow.parquet as pq  # noqa: PLC0415 - takes 5 MB, and most files are CSV

    try:
        table = FileTable(path, pq.ParquetFile(path).read(), None)
        _ = table.columns  # names in a broken file may be invalid text
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: is not a complete Parquet file: {one_line(error)}") from error
    return table
