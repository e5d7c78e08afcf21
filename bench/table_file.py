"""Read a CSV or Parquet file into named columns."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.csv as pc
import pyarrow.parquet as pq

from bench.errors import BenchError


@dataclass(frozen=True, eq=False)
class Table:
    """The columns of one file, and how a row of it is named to the user."""

    path: Path
    data: pa.Table

    @property
    def columns(self) -> list[str]:
        """Column names, in the file's order."""
        return list(self.data.column_names)

    def is_numeric(self, column: str) -> bool:
        """Whether the column holds numbers."""
        kind = self.data.schema.field(column).type
        return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_boolean(kind))

    def numbers(self, column: str) -> npt.NDArray[np.float64]:
        """The column (N,) as floats."""
        return np.asarray(self.data[column].cast(pa.float64()).to_numpy(), dtype=np.float64)


def read_table(path: Path) -> Table:
    """The table in `path`, CSV or Parquet by its suffix."""
    suffix = path.suffix.lower()
    try:
        if suffix == ".csv":
            return Table(path, pc.read_csv(path))
        if suffix == ".parquet":
            return Table(path, pq.read_table(path))
    except pa.ArrowInvalid as error:
        raise BenchError(f"{path}: cannot be read ({str(error).splitlines()[0]})") from error
    raise BenchError(f"{path}: a recording is a .csv or a .parquet file")
