"""The signals of the fitted recordings for laws, at the fit's rate, and their scope."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from bench.diagnosis.discovery.grammar import Scope
from bench.diagnosis.discovery.variables import OF_A_MOTOR, Place, Seen, Variable
from bench.diagnosis.fading import too_short
from bench.effects.load import load_at
from bench.effects.tool_motion import tool_speed
from bench.identification.partial_regression import PartialRegression
from bench.identification.prepare import Prepared
from bench.identification.tolerances import TOLERANCES
from bench.signals.decimation import decimated_indices


def places_of(prepared: Prepared) -> tuple[Place, ...]:
    """The motors at which laws may act."""
    joints = prepared.signals[0].joints
    names, rotates = tuple(joints), tuple(signals.rotates for signals in joints.values())
    return tuple(Place(names, rotates, i) for i in range(len(names)))


def seen_at(prepared: Prepared, place: Place) -> Seen:
    """Signals of fitted recordings for a law at a motor."""
    robots = prepared.fitted_signals
    step = prepared.settings.decimation
    samples = [decimated_indices(len(signals.time), step) for signals in robots]
    ends = np.cumsum([0, *map(len, samples)])

    def stacked(values: Sequence[np.ndarray]) -> np.ndarray:
        return np.concatenate([value[at] for value, at in zip(values, samples, strict=True)])

    every: dict[Variable, np.ndarray] = {Variable("time"): stacked([signals.time for signals in robots])}
    if has_tool(prepared):
        every[Variable("tool_speed")] = stacked([tool_speed(signals) for signals in robots])
    for ahead in range(len(place.motors)):
        for kind in OF_A_MOTOR:
            variable = Variable(kind, ahead)
            motor = variable.motor(place)
            every[variable] = stacked(
                [
                    load_at(signals, motor) if kind == "load" else getattr(signals.joints[motor], kind)
                    for signals in robots
                ]
            )
    if are_several(place):
        others = [Variable("load", ahead) for ahead in range(1, len(place.motors))]
        every[Variable("others_load")] = np.sum([every[other] for other in others], axis=0)
    rate = next(iter(robots[0].joints.values())).rate
    return Seen(every, [slice(int(a), int(b)) for a, b in pairwise(ends)], step / rate)


def scope_of(prepared: Prepared, regression: PartialRegression, places: Sequence[Place]) -> Scope:
    """The scope of laws."""
    fitted = prepared.fitted
    positions = np.concatenate([observation.position for observation in fitted])
    slides = [j for j, place in enumerate(places) if not place.rotates[place.index]]
    travel = float(np.ptp(positions[:, slides], axis=0).max()) if slides else 0.0
    waves = [(1.0, TOLERANCES.laws.harmonics)] if len(slides) < len(places) else []
    waves += [(2.0 * np.pi / travel, TOLERANCES.laws.waves)] if travel > 0.0 else []
    robots = prepared.fitted_signals
    interval = prepared.settings.decimation / next(iter(robots[0].joints.values())).rate
    return Scope(
        others=len(places) - 1,
        several=are_several(places[0]),
        tool=has_tool(prepared),
        duration=max(float(observation.time[-1] - observation.time[0]) for observation in fitted),
        lowest=float(positions.min()),
        highest=float(positions.max()),
        rates=tuple((number * rate, 0.5 * rate) for rate, numbers in waves for number in numbers),
        pulses=_pulses(regression, [len(observation.time) for observation in fitted], interval),
        shortest=interval,
        of_time=too_short(prepared.dataset.recordings) is None,
    )


def are_several(place: Place) -> bool:
    """Whether a motor has several others, all of one kind, so that their loads can be added."""
    return len(place.motors) > 2 and len(set(place.rotates)) == 1


def has_tool(prepared: Prepared) -> bool:
    """Whether the robot has a tool frame."""
    return prepared.model.geometry.tool is not None


def _pulses(regression: PartialRegression, lengths: Sequence[int], interval: float) -> tuple[float, ...]:
    """Prominent frequencies, rad/s, of the errors of all recordings together, motor by motor."""
    size = TOLERANCES.laws.pulse_steps * max(lengths)
    parts = np.split(regression.remainder, np.cumsum(lengths)[:-1])
    power = sum(np.abs(np.fft.rfft(part, n=size, axis=0)) ** 2 for part in parts)
    frequencies = 2.0 * np.pi * np.fft.rfftfreq(size, interval)
    pulses: list[float] = []
    for spectrum in np.asarray(power).T:
        inside = spectrum[1:-1]
        peaks = 1 + np.flatnonzero((inside > spectrum[:-2]) & (inside >= spectrum[2:]))
        peaks = peaks[peaks > TOLERANCES.laws.pulse_steps]  # at least a period within a recording
        pulses += frequencies[peaks[np.argsort(spectrum[peaks])[::-1][: TOLERANCES.laws.pulses]]].tolist()
    return tuple(sorted(set(pulses)))
