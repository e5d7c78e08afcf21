"""A summary as people read it: in a terminal, and as Markdown."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.table import Table

from bench.sweep.summary import Spread, Summary, is_share


def summary_table(summary: Summary) -> Table:
    """Rows by axes; of each metric the median and in brackets the middle 90 %, of a share its mean."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, header_style="dim", show_edge=False)
    for axis in summary.axes:
        table.add_column(axis, overflow="fold")
    for name in _headers(summary):
        table.add_column(name, justify="right", overflow="fold")
    for row in _rows(summary):
        table.add_row(*row)
    return table


def summary_markdown(summary: Summary) -> str:
    """The same as a Markdown table, with a line on what the numbers are."""
    headers = [*summary.axes, *_headers(summary)]
    lines = [
        "| " + " | ".join(headers) + " |",
        "|" + "|".join(["---"] * len(summary.axes) + ["---:"] * (len(headers) - len(summary.axes))) + "|",
        *("| " + " | ".join(row) + " |" for row in _rows(summary)),
    ]
    return "\n".join([*lines, "", explanation(summary)]) + "\n"


def explanation(summary: Summary) -> str:
    """What the numbers of a summary are."""
    text = "Median, and in brackets the middle 90 % of the runs."
    if any(is_share(metric) for metric in summary.metrics):
        text += " Of a share: the mean, and in brackets its 95 % interval (Jeffreys)."
    return text


def number(value: float) -> str:
    """Four significant digits at most."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.4g}"


def _headers(summary: Summary) -> list[str]:
    failed = any(line.failed for line in summary.lines)
    return ["runs", *(["failed"] if failed else []), *summary.metrics]


def _rows(summary: Summary) -> list[list[str]]:
    failed = any(line.failed for line in summary.lines)
    return [
        [
            *(_label(value) for value in line.values),
            str(line.runs),
            *([str(line.failed)] if failed else []),
            *(_cell(metric, line.spreads[metric]) for metric in summary.metrics),
        ]
        for line in summary.lines
    ]


def _label(value: Any) -> str:
    return number(value) if isinstance(value, float) else str(value)


def _cell(metric: str, spread: Spread) -> str:
    if not spread.count:
        return "–"
    middle = spread.mean if is_share(metric) else spread.median
    if spread.count == 1 and not is_share(metric):
        return number(middle)
    return f"{number(middle)} [{number(spread.low)}, {number(spread.high)}]"
