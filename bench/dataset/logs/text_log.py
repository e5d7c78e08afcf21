"""A log in text form: a table of numbers, possibly below a preamble, without a header, or with a line of units.

The lines of the table are those with the most frequent number of values. Preamble are all lines before the first of
them, comments (#, %, //) on top, and lines of text that a spreadsheet has padded with separators to the width of the
table. The first line of the table names the columns. If all of its values are numbers (but not just 0, 1, 2 ... or 1,
2, 3 ...), the comment just above names the columns if it has as many words; otherwise they are called 1, 2, 3 ... in
order. A second line holds the units if none of its values is a number and most are units (deg, ms, mA ...). Values
are separated by comma, semicolon, tab or blanks. The text is UTF-8, UTF-16 with a byte order mark, or Windows-1252.
"""

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.csv_text import LINE, CsvText, decoded, is_number, utf_16
from bench.basics.files.cut_off import refuse_cut_off
from bench.basics.plural import plural
from bench.dataset.logs.units import bracketed, unit_named

LOOKED_AT = 400  # lines from which the layout of the table is inferred
DELIMITERS = "\t;, "  # in case of a tie the first one is used
COMMENTS = ("#", "%", "//")
CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f]")  # bytes that no text contains


@dataclass(frozen=True)
class TextLog:
    """The text of the table, units by column, and notes on how it was read."""

    text: CsvText
    units: dict[str, str]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class _Line:
    number: int  # as an editor counts, from 1
    start: int  # offset in the text
    text: str


def split_log(path: Path, content: bytes, skip_rows: int = 0, header: bool | None = None) -> TextLog:
    """Find the table in a log. skip_rows: number of lines to skip at the top; header: whether the table's first line
    names the columns, None to infer it.

    Raises BenchError where there is no table.
    """
    text, encoding = _text(path, content)
    lines = [
        _Line(number, match.start(), match.group().rstrip("\r\n"))
        for number, match in enumerate(islice(LINE.finditer(text), LOOKED_AT), 1)
    ][skip_rows:]
    rows = [line for line in lines if line.text.strip() and not _comment(line)]
    if not rows:
        raise BenchError(f"{path}: no table of numbers" + (f" after {skip_rows} lines" if skip_rows else ""))
    delimiter = _delimiter(rows)
    count = Counter(len(_cells(line.text, delimiter)) for line in rows).most_common(1)[0][0]
    table = [line for line in rows if len(_cells(line.text, delimiter)) == count]
    table = _with_header(rows, table, delimiter)
    table = table[_padded([_cells(line.text, delimiter) for line in table]) :]
    notes = [*encoding, *([f"the first {skip_rows} lines are skipped, as requested"] if skip_rows else [])]
    if above := _above(lines, table[0]):
        notes.append(f"the preamble up to line {above[-1].number} is skipped")
    names, used = _names(lines, table, delimiter, header)
    if names is None:
        if header is None:
            _refuse_other_header(path, lines, table, delimiter)
        names = [str(i + 1) for i in range(count)]
        notes.append(f"no line names the columns: they are called 1 to {count} in their order")
    units: dict[str, str] = {}
    if used < len(table) and used > 0 and _is_units(cells := _cells(table[used].text, delimiter)):
        units = {name: unit for name, unit in zip(names, cells, strict=True) if unit}
        notes.append(f"line {table[used].number} is read as units")
        used += 1
    if used == len(table):
        raise BenchError(f"{path}: has a header but no rows")
    units |= {name: unit for name in names if (unit := bracketed(name)) and unit_named(unit)}
    first = table[used]
    body = text[first.start :]
    refuse_cut_off(path, body, delimiter)
    if delimiter == " ":  # several blanks are one separator
        delimiter, body = ";", "\n".join(";".join(line.split()) for line in body.splitlines())
    decimal_comma = delimiter != "," and "," in first.text
    csv_text = CsvText(path, tuple(names), body, first.number, delimiter, decimal_comma)
    return TextLog(csv_text, units, tuple(notes))


def _with_header(rows: Sequence[_Line], table: list[_Line], delimiter: str) -> list[_Line]:
    """The table with the line of names above it, if all its lines but not the names end with a separator."""
    above = [line for line in rows if line.number < table[0].number]
    if not above or any(_cells(line.text, delimiter)[-1] for line in table):
        return table
    names, count = _cells(above[-1].text, delimiter), len(_cells(table[0].text, delimiter))
    if len(names) != count - 1 or any(map(_is_number, names)):
        return table
    return [_Line(above[-1].number, above[-1].start, f"{above[-1].text}{delimiter}"), *table]


def _text(path: Path, content: bytes) -> tuple[str, tuple[str, ...]]:
    """A file's text, and a note on its encoding if that is not UTF-8, as from many controllers and spreadsheets."""
    if name := utf_16(content):
        try:
            return content.decode(name), ("read as UTF-16 text",)
        except UnicodeDecodeError:
            raise BenchError(f"{path}: begins like UTF-16 text but is not") from None
    try:
        return decoded(path, content), ()
    except BenchError:
        if CONTROL.search(content):
            raise
        try:
            return content.decode("cp1252"), ("read as Windows-1252 (Latin-1) text, because it is not UTF-8",)
        except UnicodeDecodeError:
            pass
        raise


def _comment(line: _Line) -> bool:
    return line.text.lstrip().startswith(COMMENTS)


def _padded(table: Sequence[Sequence[str]]) -> int:
    """Number of lines at the top that are padded text, above the names or above samples without names."""
    filled = [sum(map(bool, cells)) for cells in table]
    first = next((i for i, cells in enumerate(table) if 2 * filled[i] > len(cells)), 0)
    named = not any(map(_is_number, table[first])) and not _is_units(table[first])
    above = 0
    for cells, count in zip(table[:first], filled, strict=False):
        text = bool(cells[0]) and not _is_number(cells[0]) and not cells[-1]
        if not text or (not named and (count > 1 or len(cells) == 2)):
            break
        above += 1
    return above


def _above(lines: Sequence[_Line], first: _Line) -> list[_Line]:
    """The lines with text above the table's first one."""
    return [line for line in lines if line.number < first.number and line.text.strip()]


def _names(
    lines: Sequence[_Line], table: Sequence[_Line], delimiter: str, header: bool | None
) -> tuple[list[str] | None, int]:
    """The names of the columns, None if no line has them, and the number of lines of the table that they occupy."""
    cells = _cells(table[0].text, delimiter)
    if header is False:
        return None, 0
    if header is None and all(map(_is_number, cells)) and not _count_columns(cells):
        above = _above(lines, table[0])
        if above and _comment(above[-1]):
            said = _cells(above[-1].text.lstrip().lstrip("#%/").strip(), delimiter)
            if len(said) == len(cells):
                return said, 0
        return None, 0
    return cells, 1


def _is_number(cell: str) -> bool:
    """Whether a cell is a number, with a decimal point or comma."""
    return is_number(cell.replace(",", "."))


def _count_columns(cells: Sequence[str]) -> bool:
    """Whether the values are 0, 1, 2 ... or 1, 2, 3 ...: numbers as column names, not a sample."""
    return any(list(cells) == [str(i + first) for i in range(len(cells))] for first in (0, 1))


def _refuse_other_header(path: Path, lines: Sequence[_Line], table: Sequence[_Line], delimiter: str) -> None:
    """Raise BenchError if the table has more or fewer columns than names above it: the mapping would be a guess."""
    above = _above(lines, table[0])
    if not above or _comment(above[-1]):
        return
    names, count = _cells(above[-1].text, delimiter), len(_cells(table[0].text, delimiter))
    if 2 * len([name for name in names if name]) > count and not any(map(_is_number, names)):
        raise BenchError(
            f"{path}: line {above[-1].number}: names {plural(len(names), 'column')}, the lines below have "
            f"{plural(count, 'value')}: mend it, or add --no-header and map columns by number"
        )


def _cells(text: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return text.split()
    try:
        return [cell.strip() for cell in next(csv.reader([text], delimiter=delimiter), [])]
    except csv.Error:
        return [text]


def _delimiter(rows: Sequence[_Line]) -> str:
    """The separator that yields most numbers in the lower half of the lines, where there is no preamble."""
    lower = rows[len(rows) // 2 :]

    def numbers(delimiter: str) -> int:
        cells = (cell for line in lower for cell in _cells(line.text, delimiter))
        return sum((is_number(cell) if delimiter == "," else _is_number(cell)) for cell in cells)

    return max(DELIMITERS, key=numbers)


def _is_units(cells: Sequence[str]) -> bool:
    given = [cell for cell in cells if cell]
    if not given or any(map(_is_number, given)):
        return False
    return 2 * sum(unit_named(cell) is not None for cell in given) > len(given)
