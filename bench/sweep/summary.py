"""A sweep in a few numbers: median and spread of a metric, by axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import betaincinv

from bench.errors import BenchError
from bench.sweep.table import column_names, read_table

SPREAD = (0.05, 0.95)
SHARES = ("gain_within", "parameter_within")
"""Metrics that are a share of successes: their mean is a coverage."""


@dataclass(frozen=True)
class Spread:
    """A metric over the runs of one cell. low, high: 5 % and 95 % quantiles; of a share, its 95 % interval."""

    count: int
    median: float
    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class Line:
    """One combination of values of the axes, with the spread of every metric."""

    values: tuple[Any, ...]
    runs: int
    failed: int
    spreads: Mapping[str, Spread]


@dataclass(frozen=True)
class Summary:
    """A table by axes, in the order in which their values come first."""

    axes: tuple[str, ...]
    metrics: tuple[str, ...]
    lines: tuple[Line, ...]


def summarise(table: Path, axes: Sequence[str], metrics: Sequence[str]) -> Summary:
    """Summary of a Parquet table of runs.

    Raises BenchError if the table has no such column, or one of numbers where a number is needed.
    """
    columns = read_table(table, ["status", *dict.fromkeys((*axes, *metrics))])
    keys = (
        list(zip(*(columns[axis] for axis in axes), strict=True)) if axes else [()] * len(columns["status"])
    )
    ok = np.array([status == "ok" for status in columns["status"]], dtype=bool)
    places: dict[tuple[Any, ...], list[int]] = {}
    for i, key in enumerate(keys):
        places.setdefault(key, []).append(i)
    values = {metric: _numbers(table, metric, columns[metric]) for metric in metrics}
    lines = []
    for key, found in places.items():
        rows = np.array(found)
        good = rows[ok[rows]]
        spreads = {metric: spread(metric, values[metric][good]) for metric in metrics}
        lines.append(Line(key, len(rows), int((~ok[rows]).sum()), spreads))
    return Summary(tuple(axes), tuple(metrics), tuple(lines))


def spread(metric: str, values: np.ndarray) -> Spread:
    """Median, mean and quantiles of the values (n,) that are numbers; of a share, its interval."""
    known = values[~np.isnan(values)]
    if not len(known):
        return Spread(0, *[float("nan")] * 4)
    mean, median = float(np.mean(known)), float(np.median(known))
    if is_share(metric):
        low, high = share_interval(float(known.sum()), len(known))
    else:
        low, high = (float(x) for x in np.quantile(known, SPREAD))
    return Spread(len(known), median, mean, low, high)


def is_share(metric: str) -> bool:
    """Whether the mean of a metric is a share of successes."""
    return metric.split(".", maxsplit=1)[0] in SHARES


def share_interval(successes: float, trials: int) -> tuple[float, float]:
    """95 % interval of a share (Jeffreys: quantiles of Beta(successes + 1/2, failures + 1/2))."""
    failures = trials - successes
    low = float(betaincinv(successes + 0.5, failures + 0.5, 0.025)) if successes > 0 else 0.0
    high = float(betaincinv(successes + 0.5, failures + 0.5, 0.975)) if failures > 0 else 1.0
    return low, high


def metric_columns(table: Path) -> list[str]:
    """Names of all columns, for messages."""
    return column_names(table)


def _numbers(table: Path, name: str, values: Sequence[Any]) -> np.ndarray:
    try:
        return np.array([np.nan if value is None else float(value) for value in values])
    except ValueError:
        raise BenchError(f"{table}: column {name!r} does not hold numbers") from None
