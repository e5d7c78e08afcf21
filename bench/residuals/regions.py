"""Parts of a motion in which a motor's error may be concentrated."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from bench.residuals.autocorrelation import correlations
from bench.residuals.bounds import ERROR_GRID, NAMING
from bench.residuals.motor import MotorSeries


class RegionKind(StrEnum):
    """The variable that defines a region; `bench.residuals.words` has the words."""

    REVERSALS = "reversals"
    STANDSTILL = "standstill"
    LOW_SPEED = "low speed"
    HIGH_SPEED = "high speed"
    LOW_ACCELERATION = "low acceleration"
    HIGH_ACCELERATION = "high acceleration"
    LOW_CURRENT = "low current"
    HIGH_CURRENT = "high current"
    FORWARDS = "forwards"
    BACKWARDS = "backwards"
    LOW_POSITION = "low position"
    MIDDLE_POSITION = "middle position"
    HIGH_POSITION = "high position"
    START = "start"
    END = "end"
    UNLOADED = "without payload"
    PAYLOAD = "with payload"
    RECORDING = "recording"


OF_DATA = (RegionKind.UNLOADED, RegionKind.PAYLOAD, RegionKind.RECORDING)  # rather than of the motion


@dataclass(frozen=True)
class RegionPlace:
    """A part of the motion by a variable, its bounds in `unit`; subject: the payload or the recording."""

    part: RegionKind
    bounds: tuple[float, ...] = ()
    unit: str = ""
    subject: str = ""

    @property
    def name(self) -> str:
        """As in "low speed" or "recording run.csv"."""
        return f"{self.part} {self.subject}" if self.subject else str(self.part)


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the motion. rows: for every recording, which rows belong to it."""

    where: RegionPlace
    rows: tuple[np.ndarray, ...]


def regions(series: Sequence[MotorSeries], unit: str, current: str) -> list[Region]:
    """All regions of one motor that hold some of its rows, but not all. unit: rad or m; current: A or V."""
    speed = [np.abs(trace.velocity) for trace in series]
    acceleration = [np.abs(trace.acceleration) for trace in series]
    load = [np.abs(trace.modelled) for trace in series]
    candidates = [
        Region(RegionPlace(RegionKind.REVERSALS), tuple(trace.at_reversal for trace in series)),
        Region(RegionPlace(RegionKind.STANDSTILL), tuple(trace.near_standstill for trace in series)),
        *_by_size((RegionKind.LOW_SPEED, RegionKind.HIGH_SPEED), speed, f"{unit}/s"),
        *_by_size((RegionKind.LOW_ACCELERATION, RegionKind.HIGH_ACCELERATION), acceleration, f"{unit}/s²"),
        *_by_size((RegionKind.LOW_CURRENT, RegionKind.HIGH_CURRENT), load, current),
        Region(RegionPlace(RegionKind.FORWARDS), tuple(trace.forwards for trace in series)),
        Region(RegionPlace(RegionKind.BACKWARDS), tuple(~trace.forwards for trace in series)),
        *_by_position([trace.position for trace in series], unit),
        *_by_time(series),
        *_by_data(series),
    ]
    return [
        region
        for region in candidates
        if 0 < sum(rows.sum() for rows in region.rows) < sum(map(len, region.rows))
    ]


def _by_size(parts: tuple[RegionKind, RegionKind], sizes: Sequence[np.ndarray], unit: str) -> list[Region]:
    low, high = map(float, np.quantile(np.concatenate(sizes), (ERROR_GRID.fifth, 1.0 - ERROR_GRID.fifth)))
    return [
        Region(RegionPlace(parts[0], (low,), unit), tuple(size < low for size in sizes)),
        Region(RegionPlace(parts[1], (high,), unit), tuple(size > high for size in sizes)),
    ]


def _by_position(positions: Sequence[np.ndarray], unit: str) -> list[Region]:
    shares = (ERROR_GRID.fifth, 0.4, 0.6, 1.0 - ERROR_GRID.fifth)
    low, below, above, high = map(float, np.quantile(np.concatenate(positions), shares))
    left, right = (tuple(x < low for x in positions), tuple(x > high for x in positions))
    between = tuple((x > below) & (x < above) for x in positions)
    return [
        Region(RegionPlace(RegionKind.LOW_POSITION, (low,), unit), left),
        Region(RegionPlace(RegionKind.MIDDLE_POSITION, (below, above), unit), between),
        Region(RegionPlace(RegionKind.HIGH_POSITION, (high,), unit), right),
    ]


def _by_time(series: Sequence[MotorSeries]) -> list[Region]:
    first = tuple(trace.time < ERROR_GRID.fifth * trace.time[-1] for trace in series)
    last = tuple(trace.time > (1.0 - ERROR_GRID.fifth) * trace.time[-1] for trace in series)
    return [Region(RegionPlace(RegionKind.START), first), Region(RegionPlace(RegionKind.END), last)]


def _by_data(series: Sequence[MotorSeries]) -> list[Region]:
    """All rows with each payload or with none, and all rows of each recording."""
    none = RegionPlace(RegionKind.UNLOADED)
    loads = [
        RegionPlace(RegionKind.PAYLOAD, subject=trace.payload) if trace.payload else none for trace in series
    ]
    logs = [RegionPlace(RegionKind.RECORDING, subject=trace.recording) for trace in series]
    counts = [len(trace.time) for trace in series]
    return [
        Region(place, tuple(np.full(count, at == place) for count, at in zip(counts, places, strict=True)))
        for places in (loads, logs)
        for place in dict.fromkeys(places)
    ]


@dataclass(frozen=True)
class Concentration:
    """A share of a motor's squared error in a share of its time.

    evidence: nats against an evenly spread error. of_rest: whether shares are of the residual outside earlier regions.
    """

    joint: str
    where: RegionPlace
    error_share: float
    time_share: float
    evidence: float
    of_rest: bool


def concentrations(series: Sequence[MotorSeries], candidates: Sequence[Region]) -> list[Concentration]:
    """The regions with far more of one motor's squared error than of its time, the most significant first.

    A second one is searched outside the first, since many regions overlap.
    """
    squares = [trace.error**2 for trace in series]
    remaining = [np.ones(len(square), dtype=bool) for square in squares]
    named: list[Concentration] = []
    while len(named) < NAMING.regions:
        independent = _independent_squares(series, squares, remaining)
        tried = [(region, *_shares(squares, region.rows, remaining)) for region in candidates]
        if not tried:
            break
        region, error, time = max(tried, key=lambda entry: _divergence(*entry[1:]))
        divergence = _divergence(error, time)
        evidence = independent * divergence
        if divergence <= NAMING.region_nats or evidence <= NAMING.regions_nats + np.log(len(candidates)):
            break
        named.append(Concentration(series[0].joint, region.where, error, time, evidence, bool(named)))
        remaining = [kept & ~rows for kept, rows in zip(remaining, region.rows, strict=True)]
    return named


def shares(series: Sequence[MotorSeries], region: Region) -> tuple[float, float]:
    """The share of one motor's squared error that lies in a region, and the region's share of the time."""
    everywhere = [np.ones(len(trace.time), dtype=bool) for trace in series]
    return _shares([trace.error**2 for trace in series], region.rows, everywhere)


def _shares(
    squares: Sequence[np.ndarray], inside: Sequence[np.ndarray], remaining: Sequence[np.ndarray]
) -> tuple[float, float]:
    """Shares of squares and of rows inside among the remaining ones."""
    both = [rows & kept for rows, kept in zip(inside, remaining, strict=True)]
    whole = sum(float(square[kept].sum()) for square, kept in zip(squares, remaining, strict=True))
    part = sum(float(square[rows].sum()) for square, rows in zip(squares, both, strict=True))
    rows, all_rows = sum(int(entry.sum()) for entry in both), sum(int(values.sum()) for values in remaining)
    return part / whole if whole else 0.0, rows / all_rows if all_rows else 1.0


def _divergence(error_share: float, time_share: float) -> float:
    """Kullback-Leibler divergence, nats, of the squared error from an even spread; zero below it.

    For n independent squares, such a large share has a probability of at most exp(-n divergence) by chance (Chernoff).
    """
    if not 0.0 < time_share < 1.0 or error_share <= time_share:
        return 0.0
    rest = 1.0 - error_share
    outside = rest * np.log(rest / (1.0 - time_share)) if rest > 0.0 else 0.0
    return float(error_share * np.log(error_share / time_share) + outside)


def _independent_squares(
    series: Sequence[MotorSeries], squares: Sequence[np.ndarray], remaining: Sequence[np.ndarray]
) -> float:
    """Effective number of remaining squares, as of blocks as long as their (squared) autocorrelation."""
    alike = correlations([trace.row for trace in series], [trace.error for trace in series]) ** 2
    length = max(int(np.ceil(2.0 * alike.sum() - 1.0)), 1)
    kept = [square[rows] for square, rows in zip(squares, remaining, strict=True) if rows.any()]
    if not kept:
        return 0.0
    blocks = np.concatenate([np.add.reduceat(entry, np.arange(0, len(entry), length)) for entry in kept])
    energy = float(blocks @ blocks)
    return float(blocks.sum() ** 2 / energy) if energy else 0.0
