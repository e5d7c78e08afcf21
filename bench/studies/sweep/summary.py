"""A sweep in a few numbers: median and spread of a metric, by axis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import betaincinv

from bench.basics.errors import BenchError
from bench.studies.sweep.metrics import is_share
from bench.studies.sweep.table import read_table

SPREAD = (0.05, 0.95)
PARTS = 12  # a drawn axis, which has another value in every run, is cut into as many parts of equal count
MOST_VALUES = 40


@dataclass(frozen=True)
class Spread:
    """A metric over the runs of one cell. middle: median; low, high: 5 % and 95 % quantiles.

    Of a share: the mean, and its 95 % interval.
    """

    count: int
    middle: float
    low: float
    high: float


@dataclass(frozen=True)
class SummaryPart:
    """Values of an axis that are too many to stand alone: the least, the median and the largest of them."""

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
    """A table by axes, in the order in which their values come first."""

    axes: tuple[str, ...]
    metrics: tuple[str, ...]
    lines: tuple[SummaryLine, ...]


def summarise(table: Path, axes: Sequence[str], metrics: Sequence[str]) -> Summary:
    """Summary of a Parquet table of runs, a line for each combination of the axes' values.

    Raises BenchError if the table has no such column, or one of numbers where a number is needed.
    """
    columns = read_table(table, ["status", *dict.fromkeys((*axes, *metrics))])
    return _summary(table, columns, [(axis, columns[axis]) for axis in axes], metrics)


def summarise_in_parts(table: Path, axes: Sequence[str], metrics: Sequence[str]) -> Summary:
    """The same for any columns as axes: one of numbers is cut into 12 parts, see `Part`,
    if there are more than 40, or more than 12 of which most are of a single run.

    Axes of numbers rise from line to line, the first axis slowest.
    """
    columns = read_table(table, ["status", *dict.fromkeys((*axes, *metrics))])
    summary = _summary(table, columns, [(axis, _in_parts(columns[axis])) for axis in axes], metrics)
    lines = sorted(summary.lines, key=lambda line: [rank(value) for value in line.values])
    return Summary(summary.axes, summary.metrics, tuple(lines))


def _in_parts(values: Sequence[Any]) -> list[Any]:
    """Numbers (n,) replaced by the part that they are in, if they are many; None stays None."""
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
    """Numbers by size, everything else after them as it came."""
    if isinstance(value, SummaryPart):
        return 0, value.middle
    return (0, float(value)) if isinstance(value, int | float) else (1, 0.0)


def _summary(
    table: Path,
    columns: Mapping[str, Sequence[Any]],
    by: Sequence[tuple[str, Sequence[Any]]],
    metrics: Sequence[str],
) -> Summary:
    keys = list(zip(*(values for _, values in by), strict=True)) if by else [()] * len(columns["status"])
    ok = np.array([status == "ok" for status in columns["status"]], dtype=bool)
    places: dict[tuple[Any, ...], list[int]] = {}
    for i, key in enumerate(keys):
        places.setdefault(key, []).append(i)
    values = {metric: _numbers(table, metric, columns[metric]) for metric in metrics}
    lines = []
    for key, indices in places.items():
        rows = np.array(indices)
        good = rows[ok[rows]]
        spreads = {metric: spread(metric, values[metric][good]) for metric in metrics}
        lines.append(SummaryLine(key, len(rows), int((~ok[rows]).sum()), spreads))
    return Summary(tuple(axis for axis, _ in by), tuple(metrics), tuple(lines))


def spread(metric: str, values: np.ndarray) -> Spread:
    """The spread of the values (n,) that are numbers."""
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
