"""Findings on logged velocities: that they are used, that they are not rates of positions, that time is wrong."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.basics.joint_units import units_of_gain
from bench.dataset.logs.units import unit_of_velocity
from bench.dataset.recording import Recording
from bench.dataset.robot import Robot
from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding
from bench.signals.bounds import LOGGED
from bench.signals.processing import LoggedVelocity

Compared = Sequence[tuple[Recording, Mapping[str, LoggedVelocity]]]
"""Recordings, and how their logged velocities compare with their positions, by joint."""


@dataclass(frozen=True)
class _Unlike:
    """A velocity that is not the rate of its position; unit: its apparent unit, "" for none."""

    recording: str
    joint: str
    velocity: LoggedVelocity
    unit: str


def velocity_findings(robot: Robot, compared: Compared) -> list[Finding]:
    """Which logged velocities are used, which are not the rate of their position, and which contradict the time."""
    taken = [
        (joint, velocity) for _, every in compared for joint, velocity in every.items() if velocity.taken
    ]
    findings = []
    if taken:
        quieter = float(np.median([1.0 / max(velocity.louder, 1e-12) for _, velocity in taken]))
        names = tuple(dict.fromkeys(joint for joint, _ in taken))
        findings.append(Finding(Code.VELOCITY_TAKEN, names, numbers={"quieter": quieter}))
    factors = {recording.name: time_factor(robot, every) for recording, every in compared}
    wrong = {name: factor for name, factor in factors.items() if factor is not None}
    if wrong:
        factor = float(np.median([*wrong.values()]))
        step = next(1.0 / recording.rate for recording, _ in compared if recording.name in wrong)
        numbers = {"factor": factor, "step": 1e3 * step, "true": 1e3 * step * factor}
        findings.append(Finding(Code.TIME_BASE, tuple(wrong), numbers=numbers))
    unlike = [
        each
        for recording, every in compared
        if recording.name not in wrong
        for each in _unlike(robot, recording, every)
    ]
    if unlike:
        worst = max(unlike, key=lambda each: each.velocity.off)
        numbers = {name: getattr(worst.velocity, name) for name in ("off", "scale", "delay")}
        numbers["count"] = float(len(unlike))
        findings.append(
            Finding(Code.VELOCITY_UNLIKE, (worst.joint, worst.recording), numbers=numbers, unit=worst.unit)
        )
    return findings


def time_factor(robot: Robot, compared: Mapping[str, LoggedVelocity]) -> float | None:
    """Factor by which a log took longer than its time column says, if the velocities of all joints that show it agree.

    None if only one joint shows it, whose velocity may be in another unit, or if units explain the factor.
    """
    clear = {joint: velocity for joint, velocity in compared.items() if velocity.other < RULE.loose}
    usable = all(velocity.scale > 0.0 and not velocity.agrees for velocity in clear.values())
    if len(clear) < 2 or not usable or any(_unit(robot, *each) for each in clear.items()):
        return None
    factors = np.log([velocity.scale for velocity in clear.values()])
    if RULE.certain * float(factors.std(ddof=1)) > abs(float(factors.mean())):
        return None
    return float(np.exp(-factors.mean()))


def _unlike(robot: Robot, recording: Recording, every: Mapping[str, LoggedVelocity]) -> Iterator[_Unlike]:
    for joint, velocity in every.items():
        if not velocity.agrees:
            yield _Unlike(recording.name, joint, velocity, _unit(robot, joint, velocity))


def _unit(robot: Robot, joint: str, velocity: LoggedVelocity) -> str:
    """The unit in which a velocity is the rate of its position; "" for SI, or if there is none."""
    if velocity.other >= RULE.loose:
        return ""
    gain_unit = next(motor.gain_unit for motor in robot.motors if motor.joint == joint)
    return unit_of_velocity(velocity.scale, units_of_gain(gain_unit).rotates, LOGGED.unit)
