"""The curves of one recording in the viewer: currents, errors, torques of effects, the tool's motion, and phases."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr

from bench.dataset.payload import Payload
from bench.document.colours import (
    BACKWARDS_ON_DARK,
    FORWARDS_ON_DARK,
    LADDER_ON_DARK,
    ON_DARK,
    REVERSAL_ON_DARK,
    STILL_ON_DARK,
    rgb,
)
from bench.document.numbers import error_where_moving, percent
from bench.effects.display_names import spoken
from bench.identification.result import CurrentSeries, relative_error
from bench.viewer.content import Curve, Motor, ShownContent

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
FIFTH = 0.2  # of a recording: its start, and its end, as in the analysis of its errors
NEAR_REVERSAL = 1  # rows on either side of a change of direction that count as reversal
POSITION_COLOURS = ("#5BC99B", "#C39BF0", "#E6D55A", "#F08A6B", "#9FC7C9", "#D0A0A0")
EFFECT_COLOURS = ("#7CC7A1", "#B7A3F0", "#E0908A", "#9FC7C9", "#C9CF7A")
AXES = ("x", "y", "z")
LOGGED = Curve("logged", ON_DARK.logged, 1.0)
MEASURED = Curve("measured, filtered", ON_DARK.measured, 4.0)
MODELLED = Curve("modelled", ON_DARK.modelled, 1.5)
ERROR = Curve("error", ON_DARK.error, 1.4)
HIDDEN = Curve("hidden in the simulated machine", ON_DARK.measured, 4.0)
ALL_EFFECTS = Curve("found: all effects of the model", ON_DARK.modelled, 1.6)
REMAINDER = Curve("left over: gain × error", ON_DARK.error, 1.0)
REFERENCE = "#F2F5F8"
MACHINE = Curve("simulated machine", ON_DARK.measured, 1.6)
CLOSED = Curve("as drawn", ON_DARK.modelled, 1.6)


@dataclass(frozen=True, eq=False)
class Lane:
    """One row of the state timeline: its name, the K states and the times (K,) s at which they begin, their colours."""

    name: str
    time: np.ndarray
    states: tuple[str, ...]
    colours: dict[str, str]


def lanes(series: CurrentSeries, joints: Sequence[str], payload: Payload | None) -> list[Lane]:
    """The lanes of one recording: start, middle and end with their errors, the payload, and each motor's motion."""
    ends = series.time[[0, -1]]
    motors = [_motion(series, j, joint) for j, joint in enumerate(joints)]
    return [_thirds(series), _load(ends, payload), *motors]


def motion_states(velocity: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """The state (M,) of a joint in every row: forwards, backwards, reversal or standstill."""
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
        joint, np.append(series.time[begins], series.time[-1]), (*states[begins], states[-1]), MOTION_COLOURS
    )


def send_currents(stream: rr.RecordingStream, content: ShownContent, motors: Sequence[Motor]) -> None:
    """Send every motor's logged, measured and modelled current, its position, and its error with the deviation."""
    recording, series = content.recording, content.series
    errors, ends = error_where_moving(series), content.column(series.time[[0, -1]])
    for j, motor in enumerate(motors):
        current, error = f"current/{motor.entity}", f"error/{motor.entity}"
        # The viewer draws curves in alphabetical order, later ones over earlier ones.
        content.send(stream, f"{current}/logged", recording.time, recording.current[:, j], LOGGED)
        content.send(stream, f"{current}/measured", series.time, series.measured[:, j], MEASURED)
        content.send(stream, f"{current}/modelled", series.time, series.modelled[:, j], MODELLED)
        deviation = rr.Measurements.columns(
            values=np.zeros(2),
            variances=np.full(2, content.deviation[j] ** 2),
            units=[motor.current_unit] * 2,
            names=["± standard deviation of the fitted errors"] * 2,
            colors=[rgb(ON_DARK.band)] * 2,
        )
        stream.send_columns(f"{content.root}/{error}/deviation", indexes=[ends], columns=deviation)
        content.send(stream, f"{error}/error", series.time, errors[:, j], ERROR)
        line = Curve(motor.name, POSITION_COLOURS[j % len(POSITION_COLOURS)], 3.0)
        content.send(stream, f"position/{motor.entity}", recording.time, recording.position[:, j], line)


def send_steps(stream: rr.RecordingStream, content: ShownContent, motors: Sequence[Motor]) -> None:
    """Send the errors of the earlier models and, drawn over them, of the shown one; nothing without earlier models."""
    if not content.steps:
        return
    for number, (label, series) in enumerate((*content.steps, (content.label, content.series))):
        errors = error_where_moving(series)
        colour = ON_DARK.error if series is content.series else LADDER_ON_DARK[number % len(LADDER_ON_DARK)]
        for j, motor in enumerate(motors):
            entity = f"steps/{motor.entity}/{number}"
            content.send(stream, entity, series.time, errors[:, j], Curve(label, colour, 1.4))


def send_torques(stream: rr.RecordingStream, content: ShownContent, motors: Sequence[Motor]) -> None:
    """Send the torque of hidden effects if known, that of the model's effects, and the residual torque."""
    if not content.has_torques:
        return
    errors, known, torques = error_where_moving(content.series), content.known, content.torques
    for j, motor in enumerate(motors):
        entity = f"torque/{motor.entity}"
        if known is not None and known.torque is not None:
            content.send(stream, f"{entity}/0_hidden", known.time, known.torque[:, j], HIDDEN)
        remainder = motor.gain * errors[:, j]
        content.send(stream, f"{entity}/1_left_over", content.series.time, remainder, REMAINDER)
        if torques is None or torques.total is None:
            continue
        by_effect = {name: torque[:, j] for name, torque in torques.by_effect.items()}
        acting = {name: torque for name, torque in by_effect.items() if np.nan_to_num(torque).any()}
        for number, (name, torque) in enumerate(acting.items() if len(acting) > 1 else ()):
            line = Curve(spoken(name), EFFECT_COLOURS[number % len(EFFECT_COLOURS)], 1.0)
            content.send(stream, f"{entity}/2_{name}", torques.time, torque, line)
        content.send(stream, f"{entity}/3_found", torques.time, torques.total[:, j], ALL_EFFECTS)


def send_tool(stream: rr.RecordingStream, content: ShownContent, motors: Sequence[Motor]) -> None:
    """Send the tool's position and reference, the motors' reference positions, and the opening of the loops."""
    motion, wanted, known = content.motion, content.reference_path, content.known
    if motion.tool_position is not None:
        for k, axis in enumerate(AXES):
            line = Curve(axis, POSITION_COLOURS[k], 4.0)
            content.send(stream, f"tool/1_{axis}", motion.time, motion.tool_position[:, k], line)
            if wanted is not None:
                line = Curve(f"{axis}, reference", REFERENCE, 1.2)
                content.send(stream, f"tool/2_{axis}", motion.time, wanted[:, k], line)
        if wanted is not None:
            apart = 1e3 * np.linalg.norm(motion.tool_position - wanted, axis=1)
            line = Curve("actual path to reference path", ON_DARK.error, 1.6)
            content.send(stream, "following", motion.time, apart, line)
    if motion.loop_gap.size:
        content.send(stream, "loop_gap/drawn", motion.time, 1e6 * motion.loop_gap.max(axis=1), CLOSED)
    if known is not None and known.loop_gap is not None and known.loop_gap.size:
        content.send(stream, "loop_gap/machine", known.time, 1e6 * known.loop_gap.max(axis=1), MACHINE)
    if known is not None and known.reference is not None:
        for j, motor in enumerate(motors):
            line = Curve(f"{motor.name}, reference", REFERENCE, 1.2)
            content.send(stream, f"reference/{motor.entity}", known.time, known.reference[:, j], line)


def send_phases(stream: rr.RecordingStream, content: ShownContent, motors: Sequence[Motor]) -> None:
    """Send the state timeline: start, middle and end, the payload, and how every motor moves."""
    for number, lane in enumerate(lanes(content.series, [motor.name for motor in motors], content.payload)):
        entity = f"{content.root}/phases/{rr.escape_entity_path_part(f'{number + 1}_{lane.name}')}"
        used = {state: colour for state, colour in lane.colours.items() if state in lane.states}
        look = rr.StateConfiguration(
            values=list(used), labels=list(used), colors=np.array([(*rgb(c), 255) for c in used.values()])
        )
        stream.log(entity, look, static=True)
        changes = rr.StateChange.columns(state=list(lane.states))
        stream.send_columns(entity, indexes=[content.column(lane.time)], columns=changes)
