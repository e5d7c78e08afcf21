"""Read a controller's log, of any supported format, into named vectors.

.mat (MATLAB 5 to 7.2), .npz, .parquet, and text: .csv, .tsv, .txt, .dat, .log. A column or row vector becomes one
vector; the columns of a matrix become NAME[0], NAME[1], ...; the fields of a MATLAB struct become NAME.FIELD. ROS
bags: see ros_bag.
"""

import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bench.basics.errors import BenchError
from bench.basics.files.csv_text import CsvText
from bench.basics.files.table import FileTable, read_table, table_of
from bench.basics.files.toml_input import one_line
from bench.dataset.logs.clock import seconds_from_first
from bench.dataset.logs.ros_bag import is_bag, read_bag
from bench.dataset.logs.text_log import split_log
from bench.dataset.names import BAGS, TEXTS

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LogFile:
    """The content of a log: `vectors` of numbers by name, and the `table` that they are from, None for files that are
    not tables. units: those that the log states, by name; notes: how it was read, in words.
    """

    path: Path
    vectors: Mapping[str, Array]
    table: FileTable | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def texts(self) -> list[str]:
        """Columns of the table with a cell that is not a number."""
        columns = [] if self.table is None else self.table.columns
        return [column for column in columns if column and column not in self.vectors]

    @property
    def lines(self) -> CsvText | None:
        """The text of a CSV file, whose lines a message can name."""
        return None if self.table is None else self.table.text

    def clock(self, name: str) -> Array | None:
        """A column (N,) of dates or times of day, in s from the first; None if it has other content."""
        if self.table is None or name not in self.texts:
            return None
        return seconds_from_first(self.table.cells(name))

    def numbers(self, name: str) -> Array:
        """A vector (N,); KeyError for an unknown name, BenchError that names the cell if one is not a number."""
        if self.table is not None and name in self.texts:
            return self.table.numbers(name)
        return self.vectors[name]


@dataclass(frozen=True)
class Reading:
    """skip_rows: lines to skip at the top of a text; header: False if no line names columns; topic: of a ROS bag."""

    skip_rows: int = 0
    header: bool | None = None
    topic: str | None = None


AS_FOUND = Reading()


def read_log(path: str | Path, reading: Reading = AS_FOUND) -> LogFile:
    """Every vector of numbers in the file, by name; a scalar is a vector of length 1.

    Errors: BenchError in one line when the file is missing, broken, of an unknown kind or without numbers.
    """
    path = Path(path)
    readers: dict[str, Callable[[Path], LogFile]] = {".mat": _read_mat, ".npz": _read_npz}
    readers[".parquet"] = lambda file: _log_of(read_table(file))
    suffix, bag = path.suffix.lower(), is_bag(path)
    if suffix not in (*readers, *TEXTS) and not bag:
        kinds = ", ".join((*readers, *TEXTS, *BAGS))
        raise BenchError(f"{path}: a log is one of {kinds}, or the folder of a ROS 2 bag")
    if (reading.skip_rows or reading.header is not None) and suffix not in TEXTS:
        raise BenchError(
            f"{path}: rows are skipped, and a header is missing, in a text only ({', '.join(TEXTS)})"
        )
    if reading.topic is not None and not bag:
        raise BenchError(f"{path}: only a ROS bag has topics")
    if not (path.is_file() or (bag and path.is_dir())):
        raise BenchError(f"{path}: no such file")
    if bag:
        vectors, notes = read_bag(path, reading.topic)
        return LogFile(path, vectors, notes=notes)
    log = readers[suffix](path) if suffix in readers else text_log(path, _content(path), reading)
    if not log.vectors and not log.texts:
        raise BenchError(f"{path}: holds no numbers")
    return log


def _content(path: Path) -> bytes:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BenchError(f"{path}: cannot be read: {error.strerror}") from error
    if not content:
        raise BenchError(f"{path}: the file is empty")
    return content


def text_log(path: Path, content: bytes, reading: Reading) -> LogFile:
    """Parse a text as a log. Raises BenchError if it contains no table."""
    log = split_log(path, content, reading.skip_rows, reading.header)
    del content  # for a large log, this frees much memory
    return replace(_log_of(table_of(log.text)), units=log.units, notes=log.notes)


def _log_of(table: FileTable) -> LogFile:
    plain = [column for column in table.columns if column and table.is_plain(column)]
    return LogFile(table.path, {column: table.numbers(column) for column in plain}, table)


def _read_mat(path: Path) -> LogFile:
    from scipy.io import loadmat  # noqa: PLC0415 - slow to import, and few logs are from MATLAB
    from scipy.io.matlab import MatReadError  # noqa: PLC0415

    try:
        content = loadmat(path, squeeze_me=False, struct_as_record=True)
    except NotImplementedError as error:
        raise BenchError(f"{path}: is a MATLAB 7.3 file: save it in MATLAB with the option -v7") from error
    except (MatReadError, zlib.error, ValueError, TypeError, OSError, LookupError) as error:
        raise BenchError(f"{path}: is not a complete MATLAB file: {one_line(error)}") from error
    named = [_vectors(name, value) for name, value in content.items() if not name.startswith("__")]
    return LogFile(path, dict(chain(*named)))


def _read_npz(path: Path) -> LogFile:
    if not zipfile.is_zipfile(path):
        raise BenchError(f"{path}: is not a complete NumPy archive")
    vectors: dict[str, Array] = {}
    try:
        with np.load(path, allow_pickle=False) as archive:
            for name in archive.files:
                try:
                    vectors |= dict(_vectors(name, archive[name]))
                except ValueError:  # an array of Python objects: no numbers, and never unpickled
                    continue
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, KeyError) as error:
        raise BenchError(f"{path}: is not a complete NumPy archive: {one_line(error)}") from error
    return LogFile(path, vectors)


def _vectors(name: str, value: Any) -> Iterator[tuple[str, Array]]:
    """The vectors in an array: itself, its columns (time runs along the longer axis), or the fields of a struct."""
    array = np.asarray(value)
    if array.dtype.names is not None:
        for field in array.dtype.names if array.size == 1 else ():
            yield from _vectors(f"{name}.{field}", array.flat[0][field])
    elif array.dtype.kind not in "biuf" or array.size == 0:
        return
    elif array.size == max(array.shape, default=1):
        yield name, array.ravel().astype(np.float64)
    elif array.ndim == 2:
        for i, column in enumerate(array.T if array.shape[0] >= array.shape[1] else array):
            yield f"{name}[{i}]", column.astype(np.float64)
