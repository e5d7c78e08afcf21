"""A sweep in a few numbers, median and spread of a metric by axis: in a terminal and as Markdown."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from scipy.special import betaincinv

from bench.basics.errors import BenchError
from bench.studies.sweep.metrics import is_relative, is_share
from bench.studies.sweep.table import read_table

SPREAD = (0.05, 0.95)
PARTS = 12  # number of parts of equal count for a drawn axis, which has a different value in every run
MOST_VALUES = 40
GAP = 2  # characters between columns
WIDE = 132  # characters: width without a terminal

Columns = list[tuple[str, list[str]]]
"""Headers and cells."""


@dataclass(frozen=True)
class Spread:
    """A metric over the runs of one cell. middle: median; low, high: 5 % and 95 % quantiles.

    For a share: the mean and its 95 % interval.
    """

    count: int
    middle: float
    low: float
    high: float


@dataclass(frozen=True)
class SummaryPart:
    """One part of an axis with many values: its smallest, median and largest value."""

    low: float
    middle: float
    high: float

    def __str__(self) -> str:
        return f"{self.low:.3g} … {self.high:.3g}"


@dataclass(frozen=True)
class SummaryLine:
    """One combination of values of the axes, with the spread of every metric."""

    values: tuple[Any, ...]
    runs: int
    failed: int
    spreads: Mapping[str, Spread]


@dataclass(frozen=True)
class Summary:
    """A table summarised by axes; lines in the order of the first occurrence of their values."""

    axes: tuple[str, ...]
    metrics: tuple[str, ...]
    lines: tuple[SummaryLine, ...]


def summarise(table: Path, axes: Sequence[str], metrics: Sequence[str], *, in_parts: bool = False) -> Summary:
    """Summary of a Parquet table of runs, a line for each combination of the axes' values.

    in_parts: any columns are axes; a column of numbers is cut into 12 parts, see `SummaryPart`, if it has more than 40
    values, or more than 12 that mostly occur once; lines are sorted by the numbers of the axes, the first axis slowest.
    Raises BenchError if a column is missing or a metric is not numeric.
    """
    columns = read_table(table, ["status", *dict.fromkeys((*axes, *metrics))])
    by = [_in_parts(columns[axis]) if in_parts else columns[axis] for axis in axes]
    ok = np.array([status == "ok" for status in columns["status"]], dtype=bool)
    places: dict[tuple[Any, ...], list[int]] = {}
    for i, key in enumerate(zip(*by, strict=True) if by else [()] * len(ok)):
        places.setdefault(key, []).append(i)
    values = {metric: _numbers(table, metric, columns[metric]) for metric in metrics}
    lines = []
    for key, indices in places.items():
        rows = np.array(indices)
        good = rows[ok[rows]]
        spreads = {metric: spread(metric, values[metric][good]) for metric in metrics}
        lines.append(SummaryLine(key, len(rows), len(rows) - len(good), spreads))
    if in_parts:
        lines.sort(key=lambda line: [rank(value) for value in line.values])
    return Summary(tuple(axes), tuple(metrics), tuple(lines))


def _in_parts(values: Sequence[Any]) -> list[Any]:
    """Values (n,), replaced by their part if they are many numbers; None stays None."""
    known = [value for value in values if value is not None]
    distinct = len(set(known))
    many = distinct > MOST_VALUES or (distinct > PARTS and 2 * distinct > len(known))
    if not many or not all(isinstance(value, int | float) for value in known):
        return list(values)
    place: dict[Any, SummaryPart] = {}
    for part in np.array_split(np.sort(np.array(known, dtype=float)), PARTS):
        known_part = SummaryPart(float(part[0]), float(np.median(part)), float(part[-1]))
        place |= {value: known_part for value in part.tolist() if value not in place}
    return [None if value is None else place.get(value) for value in values]


def rank(value: Any) -> tuple[int, float]:
    """Sort key: numbers by size, then everything else in its order."""
    if isinstance(value, SummaryPart):
        return 0, value.middle
    return (0, float(value)) if isinstance(value, int | float) else (1, 0.0)


def spread(metric: str, values: np.ndarray) -> Spread:
    """The spread of the values (n,) that are not NaN."""
    known = values[~np.isnan(values)]
    if not len(known):
        return Spread(0, *[float("nan")] * 3)
    if is_share(metric):
        return Spread(len(known), float(np.mean(known)), *share_interval(float(known.sum()), len(known)))
    low, high = (float(x) for x in np.quantile(known, SPREAD))
    return Spread(len(known), float(np.median(known)), low, high)


def share_interval(successes: float, trials: int) -> tuple[float, float]:
    """95 % interval of a share (Jeffreys: quantiles of Beta(successes + 1/2, failures + 1/2))."""
    failures = trials - successes
    low = float(betaincinv(successes + 0.5, failures + 0.5, 0.025)) if successes > 0 else 0.0
    high = float(betaincinv(successes + 0.5, failures + 0.5, 0.975)) if failures > 0 else 1.0
    return low, high


def _numbers(table: Path, name: str, values: Sequence[Any]) -> np.ndarray:
    try:
        return np.array([np.nan if value is None else float(value) for value in values])
    except ValueError:
        raise BenchError(f"{table}: column {name!r} does not hold numbers") from None


def print_summary(summary: Summary, console: Console) -> None:
    """Print rows by axes: the median of each metric with the middle 90 % in brackets, for a share the mean with its
    interval.

    Metrics that do not fit the width of the console follow in further tables.
    """
    axes = [(_short(axis, summary.axes), cells) for axis, cells in _axis_columns(summary)]
    metrics = _metric_columns(summary)
    chosen = _count_columns(summary)
    while metrics or chosen:
        while metrics and (
            not chosen or _width([*axes, *chosen]) + _width(metrics[:1]) - GAP <= console.width
        ):
            chosen.append(metrics.pop(0))
        table = plain_table([name for name, _ in axes], [name for name, _ in chosen])
        for row in zip(*(cells for _, cells in (*axes, *chosen)), strict=True):
            table.add_row(*row)
        console.print(table)
        console.print()
        chosen = []
    if said := explanation(summary):
        console.print(f"[dim]{said}[/]")


def _width(columns: Columns) -> int:
    return sum(max(map(len, (name, *cells))) + GAP for name, cells in columns)


def plain_table(texts: Sequence[str], numbers: Sequence[str], *, no_wrap: bool = False) -> Table:
    """An empty table for a terminal, with columns of texts, which wrap, and of numbers, unless `no_wrap`."""
    table = Table(
        box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, GAP, 0, 0), header_style="dim", show_edge=False
    )
    for header in texts:
        table.add_column(header, overflow="fold")
    for header in numbers:
        table.add_column(header, justify="right", overflow="fold", no_wrap=no_wrap)
    return table


def summary_markdown(summary: Summary) -> str:
    """The same as a Markdown table, with a line that explains the numbers."""
    axes, numbers = _axis_columns(summary), _count_columns(summary) + _metric_columns(summary)
    columns = axes + numbers
    lines = [
        "| " + " | ".join(name for name, _ in columns) + " |",
        "|" + "|".join(["---"] * len(axes) + ["---:"] * len(numbers)) + "|",
        *("| " + " | ".join(row) + " |" for row in zip(*(values for _, values in columns), strict=True)),
    ]
    return "\n".join([*lines, "", explanation(summary)]).rstrip() + "\n"


def explanation(summary: Summary) -> str:
    """An explanation of the numbers of a summary; "" if they are values of single runs."""
    counts = [
        spread.count
        for line in summary.lines
        for metric, spread in line.spreads.items()
        if not is_share(metric)
    ]
    text = "Median, and in brackets the middle 90 % of the runs." if max(counts, default=0) > 1 else ""
    if any(is_share(metric) for metric in summary.metrics):
        text += " Of a share: the mean, and in brackets its 95 % interval (Jeffreys)."
    return text.strip()


def number(value: float, digits: int = 3) -> str:
    """A number to a few significant digits; larger ones rounded to an integer."""
    short = f"{value:.{digits}g}"
    return short if abs(float(short)) < 10**digits else f"{value:.0f}"


def _short(axis: str, axes: Sequence[str]) -> str:
    """The last part of an axis' name if it is unambiguous, else the whole name."""
    last = axis.rpartition(".")[2]
    alone = [other.rpartition(".")[2] for other in axes].count(last) == 1
    return last if alone and not last.isdecimal() else axis


def _axis_columns(summary: Summary) -> Columns:
    return [(axis, [_label(line.values[i]) for line in summary.lines]) for i, axis in enumerate(summary.axes)]


def _count_columns(summary: Summary) -> Columns:
    columns = [("runs", [str(line.runs) for line in summary.lines])]
    if any(line.failed for line in summary.lines):
        columns.append(("failed", [str(line.failed) for line in summary.lines]))
    return columns


def _metric_columns(summary: Summary) -> Columns:
    return [
        (metric, [_cell(metric, line.spreads[metric]) for line in summary.lines])
        for metric in summary.metrics
    ]


def _label(value: Any) -> str:
    return number(value) if isinstance(value, float) else str(value)


def _cell(metric: str, spread: Spread) -> str:
    if not spread.count:
        return "–"
    scale, unit = (100.0, " %") if is_relative(metric) else (1.0, "")
    if spread.count == 1 and not is_share(metric):
        return f"{number(scale * spread.middle)}{unit}"
    low, high = number(scale * spread.low, 2), number(scale * spread.high, 2)
    return f"{number(scale * spread.middle)}{unit} [{low}, {high}]"


def table_console() -> Console:
    """Standard output, as wide as the terminal or $COLUMNS, or `WIDE` for a file or a log."""
    console = Console(highlight=False)
    if console.is_terminal or os.environ.get("COLUMNS", "").isdecimal():
        return console
    return Console(width=WIDE, highlight=False)
