"""What a recording is doing from moment to moment, as states for a viewer's time line."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.dataset.payload import Payload
from bench.document.colours import BACKWARDS_ON_DARK, FORWARDS_ON_DARK, REVERSAL_ON_DARK, STILL_ON_DARK
from bench.document.numbers import percent
from bench.identification.result import CurrentSeries, relative_error

FORWARDS, BACKWARDS, REVERSAL, STILL = "forwards", "backwards", "reversal", "standstill"
MOTION_COLOURS = {
    FORWARDS: FORWARDS_ON_DARK,
    BACKWARDS: BACKWARDS_ON_DARK,
    REVERSAL: REVERSAL_ON_DARK,
    STILL: STILL_ON_DARK,
}
START, MIDDLE, END = "start", "middle", "end"
PHASE_COLOURS = {START: "#7A5AA6", MIDDLE: "#3E4756", END: "#2F7D74"}
PAYLOAD_COLOUR, NO_PAYLOAD_COLOUR = "#8F7A1E", "#3E4756"
FIFTH = 0.2  # of a recording that counts as its start and as its end, as in the places of errors
NEAR_REVERSAL = 1  # rows on either side of a change of direction that belong to it


@dataclass(frozen=True, eq=False)
class Lane:
    """One row of states: a name; states and the times (K,) s at which they begin; colour by state."""

    name: str
    time: np.ndarray
    states: tuple[str, ...]
    colours: dict[str, str]


def lanes(series: CurrentSeries, joints: Sequence[str], payload: Payload | None) -> list[Lane]:
    """Phases of one recording: start, middle and end with their errors, the payload, and each motor's motion."""
    ends = series.time[[0, -1]]
    motors = [_motion(series, j, joint) for j, joint in enumerate(joints)]
    return [_thirds(series), _load(ends, payload), *motors]


def motion_states(velocity: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """The state (M,) of a joint in every row: forwards, backwards, at a change of direction, or still."""
    states = np.where(velocity > 0, FORWARDS, BACKWARDS).astype(object)
    turns = np.flatnonzero((velocity[:-1] * velocity[1:] < 0) & moving[:-1] & moving[1:])
    for shift in range(1 - NEAR_REVERSAL, NEAR_REVERSAL + 1):
        states[np.clip(turns + shift, 0, len(states) - 1)] = REVERSAL
    states[~moving] = STILL
    return states


def _thirds(series: CurrentSeries) -> Lane:
    first, last = float(series.time[0]), float(series.time[-1])
    cuts = np.array([first, first + FIFTH * (last - first), last - FIFTH * (last - first)])
    part = np.searchsorted(cuts, series.time, side="right") - 1
    names = [
        f"{name}: error {percent(relative_error([_rows(series, part == k)]))}"
        for k, name in enumerate((START, MIDDLE, END))
    ]
    colours = dict(zip(names, PHASE_COLOURS.values(), strict=True))
    return Lane("phase", np.append(cuts, last), (*names, names[-1]), colours)


def _rows(series: CurrentSeries, rows: np.ndarray) -> CurrentSeries:
    return CurrentSeries(
        series.name,
        series.use,
        series.payload,
        *(
            getattr(series, name)[rows]
            for name in ("time", "measured", "modelled", "position", "velocity", "acceleration", "moving")
        ),
    )


def _load(ends: np.ndarray, payload: Payload | None) -> Lane:
    if payload is None:
        text, colour = "no payload", NO_PAYLOAD_COLOUR
    else:
        text = payload.name if payload.mass is None else f"{payload.name}, {payload.mass:g} kg"
        colour = PAYLOAD_COLOUR
    return Lane("payload", ends, (text, text), {text: colour})


def _motion(series: CurrentSeries, motor: int, joint: str) -> Lane:
    states = motion_states(series.velocity[:, motor], series.moving[:, motor])
    begins = np.flatnonzero(np.append(True, states[1:] != states[:-1]))
    return Lane(
        joint,
        np.append(series.time[begins], series.time[-1]),
        (*states[begins], states[-1]),
        MOTION_COLOURS,
    )
