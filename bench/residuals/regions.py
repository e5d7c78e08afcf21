"""Parts of a motion in which a motor's error may be concentrated."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from bench.residuals.bounds import ERROR_GRID
from bench.residuals.motor import MotorSeries


class RegionKind(StrEnum):
    """What a region is a part of the motion by; `bench.residuals.words` has the words."""

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


@dataclass(frozen=True)
class RegionPlace:
    """A part of the motion, by what: bounds of what it goes by, in `unit`; subject: the payload or the recording."""

    part: RegionKind
    bounds: tuple[float, ...] = ()
    unit: str = ""
    subject: str = ""

    @property
    def name(self) -> str:
        """As in "low speed" or "recording run.csv"."""
        return f"{self.part} {self.subject}" if self.subject else str(self.part)

    @property
    def of_motion(self) -> bool:
        """Whether it is a part of the motion itself, not all that has one payload, or one recording."""
        return self.part not in (RegionKind.UNLOADED, RegionKind.PAYLOAD, RegionKind.RECORDING)


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
        *_by_load(series),
        *_by_recording(series),
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
    between = tuple((position > below) & (position < above) for position in positions)
    return [
        Region(
            RegionPlace(RegionKind.LOW_POSITION, (low,), unit),
            tuple(position < low for position in positions),
        ),
        Region(RegionPlace(RegionKind.MIDDLE_POSITION, (below, above), unit), between),
        Region(
            RegionPlace(RegionKind.HIGH_POSITION, (high,), unit),
            tuple(position > high for position in positions),
        ),
    ]


def _by_time(series: Sequence[MotorSeries]) -> list[Region]:
    first = tuple(trace.time < ERROR_GRID.fifth * trace.time[-1] for trace in series)
    last = tuple(trace.time > (1.0 - ERROR_GRID.fifth) * trace.time[-1] for trace in series)
    return [Region(RegionPlace(RegionKind.START), first), Region(RegionPlace(RegionKind.END), last)]


def _by_load(series: Sequence[MotorSeries]) -> list[Region]:
    return [
        Region(
            RegionPlace(RegionKind.UNLOADED)
            if load is None
            else RegionPlace(RegionKind.PAYLOAD, subject=load),
            tuple(np.full(len(trace.time), trace.payload == load) for trace in series),
        )
        for load in dict.fromkeys(trace.payload for trace in series)
    ]


def _by_recording(series: Sequence[MotorSeries]) -> list[Region]:
    return [
        Region(
            RegionPlace(RegionKind.RECORDING, subject=name),
            tuple(np.full(len(trace.time), trace.recording == name) for trace in series),
        )
        for name in dict.fromkeys(trace.recording for trace in series)
    ]
