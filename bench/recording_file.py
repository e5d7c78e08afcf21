"""From a file to a checked recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bench.errors import BenchError
from bench.recording import Recording, Use
from bench.robot import Robot
from bench.table_file import read_table


def load_recording(path: Path, name: str, use: Use, payload: str | None, robot: Robot) -> Recording:
    """Read the CSV or Parquet file `path` as a recording of `robot`.

    Errors: BenchError that names the file, and the column and row where there is one.
    """
    table = read_table(path)
    needed = ["time", *(f"{kind}.{joint}" for kind in ("position", "current") for joint in robot.joints)]
    missing = [column for column in needed if column not in table.columns]
    if missing:
        raise BenchError(f"{path}: no column {', '.join(missing)} (it has {', '.join(table.columns)})")
    n = len(robot.joints)
    values = {column: table.numbers(column) for column in table.columns if column in needed}
    block = np.column_stack([values[column] for column in needed])
    extra = {c: table.numbers(c) for c in table.columns if c not in needed and table.is_numeric(c)}
    return Recording(name, use, payload, block[:, 0], block[:, 1 : n + 1], block[:, n + 1 :], extra)
