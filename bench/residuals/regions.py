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
        Region("reversals", "at reversals", tuple(one.at_reversal for one in series)),
        Region("standstill", "next to standstill", tuple(one.beside_standstill for one in series)),
        *_by_size("speed", "speed", [np.abs(one.velocity) for one in series], f"{unit}/s"),
        *_by_size("acceleration", "acceleration", [np.abs(one.acceleration) for one in series], f"{unit}/s²"),
        *_by_size("current", "current", [np.abs(one.modelled) for one in series], current),
        Region("forwards", "moving forwards", tuple(one.forwards for one in series)),
        Region("backwards", "moving backwards", tuple(~one.forwards for one in series)),
        *_by_position([one.position for one in series], unit),
        *_by_time(series),
        *_by_load(series),
        *_by_recording(series),
    ]
    return [one for one in found if 0 < sum(rows.sum() for rows in one.rows) < sum(map(len, one.rows))]


def _by_size(name: str, words: str, sizes: Sequence[np.ndarray], unit: str) -> list[Region]:
    low, high = np.quantile(np.concatenate(sizes), (FIFTH, 1.0 - FIFTH))
    return [
        Region(f"low {name}", f"at low {words} (below {low:.3g} {unit})", tuple(one < low for one in sizes)),
        Region(
            f"high {name}", f"at high {words} (above {high:.3g} {unit})", tuple(one > high for one in sizes)
        ),
    ]


def _by_position(positions: Sequence[np.ndarray], unit: str) -> list[Region]:
    low, below, above, high = np.quantile(np.concatenate(positions), (FIFTH, 0.4, 0.6, 1.0 - FIFTH))
    return [
        Region("low position", f"at positions below {low:.3g} {unit}", tuple(one < low for one in positions)),
        Region(
            "middle position",
            f"at positions between {below:.3g} and {above:.3g} {unit}",
            tuple((one > below) & (one < above) for one in positions),
        ),
        Region(
            "high position", f"at positions above {high:.3g} {unit}", tuple(one > high for one in positions)
        ),
    ]


def _by_time(series: Sequence[MotorSeries]) -> list[Region]:
    first = tuple(one.time < FIFTH * one.time[-1] for one in series)
    last = tuple(one.time > (1.0 - FIFTH) * one.time[-1] for one in series)
    return [
        Region("start", "in the first fifth of the recordings", first),
        Region("end", "in the last fifth of the recordings", last),
    ]


def _by_load(series: Sequence[MotorSeries]) -> list[Region]:
    loads = list(dict.fromkeys(one.payload for one in series))
    words = {load: "without payload" if load is None else f"with payload {load}" for load in loads}
    return [
        Region(
            words[load],
            words[load],
            tuple(np.full(len(one.time), one.payload == load) for one in series),
            "payload",
        )
        for load in loads
    ]


def _by_recording(series: Sequence[MotorSeries]) -> list[Region]:
    return [
        Region(
            f"recording {name}",
            f"in {name}",
            tuple(np.full(len(one.time), one.recording == name) for one in series),
            "recording",
        )
        for name in dict.fromkeys(one.recording for one in series)
    ]
