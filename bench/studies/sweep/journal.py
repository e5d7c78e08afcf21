"""A journal of finished runs: one complete line of JSON for each."""

import json
import os
import time
from array import array
from collections.abc import Iterable, Iterator, Sequence
from errno import ENOSPC
from io import FileIO
from pathlib import Path
from typing import Any

from bench.basics.errors import BenchError

Row = dict[str, Any]
"""One line of the table: column -> number, text, truth or None."""
OK, FAILED = "ok", "failed"  # values of a row's `status`
BETWEEN = " + "  # separator of names in one cell
TO_DISK_EVERY = 1.0  # s: a power failure loses at most this much, a killed process nothing


class Journal:
    """An append-only file of rows; the number of each row is under `run`.

    A line that was cut off by a kill is dropped when the file is opened again. The start of each row is kept in
    memory, eight bytes per run.
    """

    def __init__(self, path: Path, size: int) -> None:
        self.path = path
        self._starts = array("q", [-1]) * size
        self.count = 0
        self.failed: set[int] = set()
        end = self._read_back()
        self._file: FileIO = path.open("ab", buffering=0)  # rows are written immediately
        self._file.truncate(end)
        self._end = end
        self._synced = time.monotonic()

    def __contains__(self, number: int) -> bool:
        return self._starts[number] >= 0

    def save_rows(self, rows: Sequence[Row]) -> None:
        """Append rows. After this returns, a kill cannot lose them. Raises OSError if the disk is full."""
        for row in rows:
            line = json.dumps(row, separators=(",", ":")).encode() + b"\n"
            if self._file.write(line) < len(line):
                raise OSError(ENOSPC, os.strerror(ENOSPC))
            self._note(row, self._end)
            self._end += len(line)
        if time.monotonic() - self._synced > TO_DISK_EVERY:
            os.fsync(self._file.fileno())
            self._synced = time.monotonic()

    def rows(self) -> Iterator[Row]:
        """Rows by number, read one after the other."""
        with self.path.open("rb") as file:
            for start in self._starts:
                if start >= 0:
                    file.seek(start)
                    yield json.loads(file.readline())

    def close(self) -> None:
        """Flush to disk and close."""
        os.fsync(self._file.fileno())
        self._file.close()

    def _note(self, row: Row, start: int) -> None:
        number = row["run"]
        if not 0 <= number < len(self._starts):
            raise BenchError(f"{self.path}: run {number}, but the sweep has {len(self._starts)}")
        if self._starts[number] < 0:
            self.count += 1
        (self.failed.discard if row["status"] == OK else self.failed.add)(number)
        self._starts[number] = start

    def _read_back(self) -> int:
        """Index the existing rows; returns the end of the last complete line, bytes."""
        if not self.path.exists():
            return 0
        end = 0
        with self.path.open("rb") as file:
            for line in file:
                if not line.endswith(b"\n"):
                    break
                try:
                    self._note(json.loads(line), end)
                except (ValueError, KeyError, TypeError) as error:
                    raise BenchError(f"{self.path}: byte {end}: not a row ({error})") from error
                end += len(line)
        return end


def cell_of(names: Iterable[str]) -> str:
    """Names as one text, empty for no names."""
    return BETWEEN.join(names)


def names_in(cell: str) -> tuple[str, ...]:
    """The inverse of `cell_of`."""
    return tuple(cell.split(BETWEEN)) if cell else ()
