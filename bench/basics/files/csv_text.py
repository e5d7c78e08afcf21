"""The text of a CSV file: its header, its dialect, and the location of rows and cells.

A fast reader elsewhere parses the numbers. This module returns the line number of a row and the text of a cell,
mainly for messages about faults.
"""

import csv
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.cut_off import refuse_cut_off
from bench.basics.plural import plural

DELIMITERS = ",;\t"
# characters: the cells of a text up to this size are cached; a larger text is parsed again for each request
KEPT = 1 << 25
SEEN = 256  # bytes from which UTF-16 is recognised
LINE = re.compile(r"[^\r\n]*(?:\r\n|\n|\r)|[^\r\n]+\Z")
FOREIGN = {
    b"PAR1": "a Parquet file",
    b"PK\x03\x04": "an Excel workbook or a zip archive",
    b"MATLAB 5.0": "a MATLAB file",
    b"\x89HDF": "an HDF5 file (MATLAB 7.3 writes them)",
    b"\x93NUMPY": "a NumPy file",
}
UTF_16 = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
"""Byte order mark of UTF-16 -> Python's name of the encoding."""


@dataclass(frozen=True)
class CsvText:
    """A file `path`: the `names` of its header, and the text `body` after it, which begins at line `first_line`."""

    path: Path
    names: tuple[str, ...]
    body: str
    first_line: int
    delimiter: str
    decimal_comma: bool

    def line(self, row: int) -> int:
        """Line number of data row `row` (0 is the first); the file's first line is 1."""
        return self._row(row)[0]

    def cell(self, row: int, column: int) -> str:
        """The text of a cell without surrounding spaces."""
        return self._row(row)[1][column].strip()

    def cells(self, column: int, rows: range) -> list[str]:
        """The texts of a column's cells in `rows`."""
        return list(self._column(column, rows))

    def first_text(self, column: int, rows: range) -> tuple[int, str] | None:
        """Row and text of the first cell of a column in `rows` that is not a number; None if there is none."""
        for row, cell in zip(rows, self._column(column, rows), strict=False):
            try:
                if cell:
                    self.number(cell)
            except ValueError:
                return row, cell
        return None

    def floats(self, column: int, rows: range, otherwise: float | None = None) -> list[float]:
        """Numbers of a column in `rows`, including spellings that only Python reads, such as +1.5; empty cells are
        NaN.

        otherwise: value for text that is not a number; with None, such text raises ValueError.
        """
        return [self._float(cell, otherwise) for cell in self._column(column, rows)]

    def _float(self, cell: str, otherwise: float | None) -> float:
        if not cell:
            return float("nan")
        try:
            return self.number(cell)
        except ValueError:
            if otherwise is None:
                raise
            return otherwise

    def number(self, cell: str) -> float:
        """The number that a cell spells; ValueError for text."""
        return float(cell.replace(",", ".") if self.decimal_comma else cell)

    def ragged(self) -> str | None:
        """A message on the first line with more or fewer values than the header has names; None if there is none."""
        rows = iter(self._all())
        for line, cells in rows:
            if len(cells) != len(self.names):
                last = next(rows, None) is None
                comma = len(cells) > len(self.names) and self.delimiter == ","
                hint = " (decimal commas? then separate the values by semicolons)" if comma else ""
                cure = "the file breaks off there: remove that line" if last else "mend or remove that line"
                held = plural(len(cells), "value")
                return f"line {line}: has {held}, the header names {len(self.names)}{hint}; {cure}"
        return None

    def _column(self, column: int, rows: range) -> Iterator[str]:
        """The cells of a column in consecutive rows."""
        for _, cells in islice(self._all(), rows.start, rows.stop):
            yield cells[column].strip()

    def _row(self, row: int) -> tuple[int, list[str]]:
        if len(self.body) <= KEPT:
            return self._rows[row]
        if row not in self._asked:
            self._asked[row] = next(islice(self._lines(), row, None))
        return self._asked[row]

    def _all(self) -> Iterable[tuple[int, list[str]]]:
        return self._rows if len(self.body) <= KEPT else self._lines()

    @cached_property
    def _rows(self) -> list[tuple[int, list[str]]]:
        return list(self._lines())

    @cached_property
    def _asked(self) -> dict[int, tuple[int, list[str]]]:
        return {}

    def _lines(self) -> Iterator[tuple[int, list[str]]]:
        """Line number and cells of each line that is not blank, in the rows of the fast reader."""
        lines = (match.group() for match in LINE.finditer(self.body))
        reader = csv.reader(lines, delimiter=self.delimiter)
        start = self.first_line
        try:
            for cells in reader:
                if cells:
                    yield start, cells
                start = self.first_line + reader.line_num
        except csv.Error as error:
            raise BenchError(f"{self.path}: line {start}: {error} (an unclosed quotation mark?)") from error


def utf_16(content: bytes) -> str | None:
    """Python's name of the UTF-16 variant of a text, from its byte order mark or its zero bytes; None for other
    encodings.
    """
    for mark, name in UTF_16.items():
        if content.startswith(mark):
            return name
    start = content[:SEEN]
    for name, zeros, letters in (
        ("utf-16-le", start[1::2], start[::2]),
        ("utf-16-be", start[::2], start[1::2]),
    ):
        if len(zeros) > 1 and not any(zeros) and all(letters[: len(zeros)]):
            return name
    return None


def decoded(path: Path, content: bytes) -> str:
    """The text of a file; BenchError if it is not text, with its kind or the line that is not UTF-8."""
    for magic, kind in FOREIGN.items():
        if content.startswith(magic):
            raise BenchError(f"{path}: is {kind}, not a CSV text")
    if utf_16(content):
        raise BenchError(
            f"{path}: is UTF-16 text: save it as UTF-8, or turn it into a recording with bench import"
        )
    if b"\x00" in content:
        padding = len(content) - len(content.rstrip(b"\x00"))
        where = content.index(0)
        if where == len(content) - padding:
            line = content.count(b"\n") + 1
            raise BenchError(
                f"{path}: line {line}: {plural(padding, 'zero byte')} up to the end: the logger broke off there; "
                "remove them"
            )
        raise BenchError(f"{path}: is not a text file (zero byte at offset {where})")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise BenchError(f"{path}: line {line}: is not UTF-8 text") from error


def split_csv(path: Path, content: bytes) -> CsvText:
    """Find header, delimiter and decimal sign of a CSV file.

    Errors: BenchError if the content is not text with a header line, or its last line is cut off.
    """
    text = decoded(path, content)
    opening = re.match(r"\s*", text)
    start = opening.end() if opening else 0
    header, end, body = re.split(r"(\r\n|\n|\r|\Z)", text[start:], maxsplit=1)
    first_line = text[:start].count("\n") + 2
    delimiter = max(DELIMITERS, key=header.count)
    try:
        names = tuple(name.strip() for name in next(csv.reader([header], delimiter=delimiter), []))
    except csv.Error as error:
        raise BenchError(f"{path}: line {first_line - 1}: is not a CSV header: {error}") from error
    if not names:
        raise BenchError(f"{path}: the file is empty")
    if all(is_number(name.replace(",", ".")) for name in names):
        raise BenchError(f"{path}: line {first_line - 1}: has no header line that names the columns")
    refuse_cut_off(path, body, delimiter)
    first_row = body.lstrip().split("\n", 1)[0]
    return CsvText(
        path, names, body if end else "", first_line, delimiter, delimiter != "," and "," in first_row
    )


def is_number(cell: str) -> bool:
    """Whether a cell is a number with a decimal point."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
