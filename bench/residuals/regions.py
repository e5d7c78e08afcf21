"""Parts of a motion in which a motor's error may be concentrated."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.residuals.motor import MotorSeries

FIFTH = 0.2


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the motion. words: as in "at reversals"; rows: for every recording, which rows belong to it.

    of: whether it is a part of the motion itself, or all that has one payload, or one recording.
    """

    name: str
    words: str
    rows: tuple[np.ndarray, ...]
    of: Literal["motion", "payload", "recording"] = "motion"


def regions(series: Sequence[MotorSeries], unit: str, current: str) -> list[Region]:
    """All regions of one motor that hold some of its rows, but not all. unit: rad or m; current: A or V."""
    found = [
        Region("reversals", "at reversals", tuple(trace.at_reversal for trace in series)),
        Region("standstill", "next to standstill", tuple(trace.beside_standstill for trace in series)),
        *_by_size("speed", "speed", [np.abs(trace.velocity) for trace in series], f"{unit}/s"),
        *_by_size(
            "acceleration", "acceleration", [np.abs(trace.acceleration) for trace in series], f"{unit}/s²"
        ),
        *_by_size("current", "current", [np.abs(trace.modelled) for trace in series], current),
        Region("forwards", "moving forwards", tuple(trace.forwards for trace in series)),
        Region("backwards", "moving backwards", tuple(~trace.forwards for trace in series)),
        *_by_position([trace.position for trace in series], unit),
        *_by_time(series),
        *_by_load(series),
        *_by_recording(series),
    ]
    return [
        region for region in found if 0 < sum(rows.sum() for rows in region.rows) < sum(map(len, region.rows))
    ]


def _by_size(name: str, words: str, sizes: Sequence[np.ndarray], unit: str) -> list[Region]:
    low, high = np.quantile(np.concatenate(sizes), (FIFTH, 1.0 - FIFTH))
    return [
        Region(
            f"low {name}", f"at low {words} (below {low:.3g} {unit})", tuple(size < low for size in sizes)
        ),
        Region(
            f"high {name}", f"at high {words} (above {high:.3g} {unit})", tuple(size > high for size in sizes)
        ),
    ]


def _by_position(positions: Sequence[np.ndarray], unit: str) -> list[Region]:
    low, below, above, high = np.quantile(np.concatenate(positions), (FIFTH, 0.4, 0.6, 1.0 - FIFTH))
    return [
        Region(
            "low position",
            f"at positions below {low:.3g} {unit}",
            tuple(position < low for position in positions),
        ),
        Region(
            "middle position",
            f"at positions between {below:.3g} and {above:.3g} {unit}",
            tuple((position > below) & (position < above) for position in positions),
        ),
        Region(
            "high position",
            f"at positions above {high:.3g} {unit}",
            tuple(position > high for position in positions),
        ),
    ]


def _by_time(series: Sequence[MotorSeries]) -> list[Region]:
    first = tuple(trace.time < FIFTH * trace.time[-1] for trace in series)
    last = tuple(trace.time > (1.0 - FIFTH) * trace.time[-1] for trace in series)
    return [
        Region("start", "in the first fifth of the recordings", first),
        Region("end", "in the last fifth of the recordings", last),
    ]


def _by_load(series: Sequence[MotorSeries]) -> list[Region]:
    loads = list(dict.fromkeys(trace.payload for trace in series))
    words = {load: "without payload" if load is None else f"with payload {load}" for load in loads}
    return [
        Region(
            words[load],
            words[load],
            tuple(np.full(len(trace.time), trace.payload == load) for trace in series),
            "payload",
        )
        for load in loads
    ]


def _by_recording(series: Sequence[MotorSeries]) -> list[Region]:
    return [
        Region(
            f"recording {name}",
            f"in {name}",
            tuple(np.full(len(trace.time), trace.recording == name) for trace in series),
            "recording",
        )
        for name in dict.fromkeys(trace.recording for trace in series)
    ]
