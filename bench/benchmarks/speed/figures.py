"""Results of speed benchmarks: named figures with their limits and last values."""

import json
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from bench.basics.errors import BenchError
from bench.basics.versions import versions
from bench.studies.sweep.summary import plain_table

HISTORY = Path("results/speed/history.jsonl")
NOTABLE = 0.15  # relative change from which a figure is coloured; smaller ones are noise


@dataclass(frozen=True)
class SpeedFigure:
    """A measured figure. limit: its upper or, with `at_least`, its lower bound; None: unlimited."""

    name: str
    value: float
    unit: str
    limit: float | None = None
    at_least: bool = False

    @property
    def kept(self) -> bool:
        """Whether the limit is kept."""
        if self.limit is None:
            return True
        return self.value >= self.limit if self.at_least else self.value <= self.limit


def last_values(path: Path = HISTORY) -> dict[str, float]:
    """The last measured value of every figure; empty without a history. Raises BenchError for a damaged history."""
    values: dict[str, float] = {}
    if path.is_file():
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            try:
                values |= json.loads(line)["figures"]
            except (ValueError, KeyError, TypeError) as error:
                raise BenchError(f"{path}: line {number}: no speed record ({error})") from error
    return values


def append_history(figures: Sequence[SpeedFigure], path: Path = HISTORY) -> None:
    """Append a line to the history: figures and units by name, versions, and machine."""
    record: dict[str, Any] = {
        "figures": {figure.name: float(f"{figure.value:.4g}") for figure in figures},
        "units": {figure.name: figure.unit for figure in figures},
        "cores": len(os.sched_getaffinity(0)),
        "machine": platform.machine(),
        **versions().columns(),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(record) + "\n")


def figures_table(figures: Sequence[SpeedFigure], last: Mapping[str, float]) -> Table:
    """A table of all figures with their last values and limits."""
    table = plain_table([""], ["last", "now", "change", "limit"], no_wrap=True)
    for figure in figures:
        before = last.get(figure.name)
        change = None if not before else figure.value / before - 1.0
        worse = change is not None and (-change if figure.at_least else change) > NOTABLE
        bound = "" if figure.limit is None else f"{'≥' if figure.at_least else '≤'} {figure.limit:g}"
        table.add_row(
            figure.name,
            "–" if before is None else f"{before:.3g}",
            f"{figure.value:.3g} {figure.unit}",
            "–" if change is None else f"{100 * change:+.0f} %",
            bound,
            style="red" if not figure.kept else "yellow" if worse else None,
        )
    return table
