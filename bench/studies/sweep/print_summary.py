"""A summary as people read it: in a terminal, and as Markdown; and the console of such tables."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from bench.studies.sweep.metrics import is_relative, is_share
from bench.studies.sweep.summary import Spread, Summary

GAP = 2  # blanks between columns


def print_summary(summary: Summary, console: Console) -> None:
    """Rows by axes; of each metric the median and in brackets the middle 90 %, of a share its mean.

    Metrics that do not fit into the console side by side follow in further tables.
    """
    axes = [_column(_short(axis, summary.axes), values) for axis, values in _axis_columns(summary)]
    counts = [_column(name, values) for name, values in _count_columns(summary)]
    metrics = [_column(name, values) for name, values in _metric_columns(summary)]
    taken = sum(column.width + GAP for column in axes)
    while metrics or counts:
        chosen, counts = counts, []
        width = taken + sum(column.width + GAP for column in chosen)
        while metrics and (not chosen or width + metrics[0].width <= console.width):
            chosen.append(metrics.pop(0))
            width += chosen[-1].width + GAP
        console.print(_table(axes, chosen))
        console.print()
    console.print(f"[dim]{explanation(summary)}[/]", highlight=False)


def summary_markdown(summary: Summary) -> str:
    """The same as a Markdown table, with a line on what the numbers are."""
    axes, numbers = _axis_columns(summary), _count_columns(summary) + _metric_columns(summary)
    columns = axes + numbers
    lines = [
        "| " + " | ".join(name for name, _ in columns) + " |",
        "|" + "|".join(["---"] * len(axes) + ["---:"] * len(numbers)) + "|",
        *("| " + " | ".join(row) + " |" for row in zip(*(values for _, values in columns), strict=True)),
    ]
    return "\n".join([*lines, "", explanation(summary)]) + "\n"


def explanation(summary: Summary) -> str:
    """What the numbers of a summary are."""
    text = "Median, and in brackets the middle 90 % of the runs."
    if any(is_share(metric) for metric in summary.metrics):
        text += " Of a share: the mean, and in brackets its 95 % interval (Jeffreys)."
    return text


def number(value: float, digits: int = 3) -> str:
    """A number to a few significant digits, large whole numbers in full."""
    short = f"{value:.{digits}g}"
    return short if abs(float(short)) < 10**digits else f"{value:.0f}"


Columns = list[tuple[str, list[str]]]


@dataclass(frozen=True)
class _Column:
    header: str
    values: list[str]
    width: int


def _column(header: str, values: list[str]) -> _Column:
    return _Column(header, values, max(len(text) for text in (header, *values)))


def _table(left_columns: list[_Column], right_columns: list[_Column]) -> Table:
    table = Table(
        box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, GAP, 0, 0), header_style="dim", show_edge=False
    )
    for column in left_columns:
        table.add_column(column.header, overflow="fold")
    for column in right_columns:
        table.add_column(column.header, justify="right", overflow="fold")
    for row in zip(*(column.values for column in (*left_columns, *right_columns)), strict=True):
        table.add_row(*row)
    return table


def _short(axis: str, axes: Sequence[str]) -> str:
    """The last part of an axis' name where no other axis ends alike."""
    last = axis.rpartition(".")[2]
    return (
        last
        if sum(other.rpartition(".")[2] == last for other in axes) == 1 and not last.isdecimal()
        else axis
    )


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


WIDE = 132  # columns where nobody's terminal sets a limit


def table_console() -> Console:
    """The standard output: as wide as its terminal, or as $COLUMNS says, or `WIDE` for a file or a log."""
    console = Console()
    if console.is_terminal or os.environ.get("COLUMNS", "").isdecimal():
        return console
    return Console(width=WIDE)
