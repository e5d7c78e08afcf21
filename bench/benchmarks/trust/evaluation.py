"""An evaluation, read from its table."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from bench.basics.errors import BenchError
from bench.benchmarks.trust.work import FRESH, FROZEN
from bench.studies.sweep.journal import Row
from bench.studies.trial.cases import Kind


@dataclass(frozen=True)
class PlannedCell:
    """A cell and the number of its cases, run or not."""

    robot: str
    question: Kind
    frozen: bool
    planned: int


@dataclass(frozen=True)
class Evaluation:
    """All rows, and the request. version: of the changelog; first: number of the first fresh case."""

    rows: tuple[Row, ...]
    version: str
    first: int
    hours: float
    cells: tuple[PlannedCell, ...]

    @property
    def robots(self) -> tuple[str, ...]:
        """All requested robots."""
        return tuple(dict.fromkeys(cell.robot for cell in self.cells))

    @property
    def commits(self) -> str:
        """Commits of the program; there is one, unless the table was assembled by hand."""
        return ", ".join(sorted({str(row["commit"]) for row in self.rows if row.get("commit")}))

    def of(self, robots: Sequence[str], kinds: Sequence[str], *, frozen: bool = False) -> list[Row]:
        """Rows of these robots and questions, of fresh or frozen cases."""
        kept = FROZEN if frozen else FRESH
        groups: dict[tuple[str, str, str], list[Row]] = {
            (at, kind, kept): [] for at in robots for kind in kinds
        }
        for row in self.rows:
            if (group := groups.get((row["robot"], row["question"], row["set"]))) is not None:
                group.append(row)
        return [row for group in groups.values() for row in group]


def read_evaluation(path: Path) -> Evaluation:
    """Read a table. Raises BenchError if there is none, or it is of another kind."""
    try:
        table = pq.read_table(path)
        asked: Mapping[str, Any] = json.loads(table.schema.metadata[b"trust"])
    except (OSError, KeyError, TypeError, pa.ArrowInvalid) as error:
        raise BenchError(f"{path}: is no table of `make trust`: {str(error).splitlines()[0]}") from error
    cells = tuple(PlannedCell(**cell) for cell in asked["cells"])
    return Evaluation(tuple(table.to_pylist()), asked["version"], asked["first"], asked["hours"], cells)
