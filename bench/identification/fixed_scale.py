"""Whether payloads fix the drive gains, and what would fix those that they do not.

Without a known load all gains, base parameters and payload parameters can grow together. A payload of known mass fixes
that scale only where nothing unknown does the same as its known torque: of a body that turns about a fixed point the
unknown first moments and inertia do. Decided by geometry and motion, never by noise.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from bench.dataset.payload import Payload
from bench.identification.gain_shares import (
    GainShares,
    LoadedStates,
    assumed,
    gain_shares,
    random_states,
    robot_length,
)
from bench.identification.scale import Scale, ScaleCase, ScaleRemedy
from bench.model.geometry import Placement
from bench.model.model import IdentificationModel
from bench.model.regressor import payload_transform

AWAY = np.array(
    [0.48, 0.64, -0.6]
)  # unit length, along no axis of a tool: where a payload fixed elsewhere is


def scale_of(
    model: IdentificationModel, payloads: Mapping[str, Payload], recorded: Sequence[LoadedStates]
) -> Scale:
    """What the payloads fix, at random states of the robot and at those that were recorded, one entry a recording.

    Gains that are fixed are fitted where the others, held at their nominal values, do not move them; redundant motors'
    gains are held with all others or not at all.
    """
    robot = model.geometry.robot
    joints = tuple(actuator.joint for actuator in (*robot.redundant, *robot.actuators))
    names = tuple(dict.fromkeys(some.payload for some in recorded if some.payload is not None))
    if not names:
        return Scale(ScaleCase.NO_PAYLOAD, held=joints)
    question = _Question(model, {name: payloads[name] for name in names}, recorded)
    shares = question.asked(())
    determined = np.all([each.determined for each in shares], axis=0)
    if determined.all():
        return Scale(ScaleCase.FIXED, names)
    open_ = tuple(joint for joint, sure in zip(joints, determined, strict=True) if not sure)
    remedies = _remedies(question, int(determined.sum()))
    if all(payload.mass is None for payload in question.payloads.values()):
        return Scale(ScaleCase.MASS_UNKNOWN, names, open_, joints, remedies)
    some = determined.any() and determined[: len(robot.redundant)].all()
    # states that leave no gain open say nothing of those that a recorded motion leaves open
    if some and all(each.apart(~determined) for each in shares if not each.determined.all()):
        return Scale(ScaleCase.FIXED_FOR_SOME, names, open_, open_, remedies)
    return Scale(ScaleCase.NOT_FIXED, names, open_, joints, remedies)


@dataclass(frozen=True)
class _Question:
    """A robot's fitted recordings with their payloads, asked with some remedies applied to all of these."""

    model: IdentificationModel
    payloads: Mapping[str, Payload]
    recorded: Sequence[LoadedStates]

    @cached_property
    def length(self) -> float:
        """The robot's, m."""
        return robot_length(self.model.geometry)

    @cached_property
    def elsewhere(self) -> tuple[IdentificationModel, Sequence[LoadedStates]]:
        """The model and what was recorded, with payloads fixed the robot's length off the tool."""
        tool = self.model.geometry.tool
        if tool is None or self.model.payload is None:
            return self.model, self.recorded
        placement = tool.placement @ Placement(np.eye(3), self.length * AWAY)
        payload = payload_transform(replace(tool, placement=placement))
        change = np.linalg.solve(self.model.payload, payload)
        moved = [
            some if some.loads is None else replace(some, loads=some.loads @ change) for some in self.recorded
        ]
        return replace(self.model, payload=payload), moved

    @property
    def possible(self) -> tuple[ScaleRemedy, ...]:
        """What can be changed at all."""
        loads = self.payloads.values()
        missing = {
            ScaleRemedy.MASS: any(payload.mass is None for payload in loads),
            ScaleRemedy.CENTER_OF_MASS: any(payload.center_of_mass is None for payload in loads),
            ScaleRemedy.INERTIA: any(payload.inertia is None for payload in loads),
            ScaleRemedy.UNLOADED: all(some.payload is not None for some in self.recorded),
        }
        return tuple(remedy for remedy in ScaleRemedy if missing.get(remedy, True))

    def asked(self, remedies: Sequence[ScaleRemedy]) -> tuple[GainShares, ...]:
        """Shares at random states, and at the recorded ones but with another motion."""
        payloads = {
            name: _declared(payload, remedies, self.length) for name, payload in self.payloads.items()
        }
        elsewhere = ScaleRemedy.ELSEWHERE in remedies
        model, recorded = self.elsewhere if elsewhere else (self.model, self.recorded)
        if ScaleRemedy.UNLOADED in remedies:
            recorded = [*recorded, *(replace(some, payload=None, loads=None) for some in recorded)]
        at_random = gain_shares(model, payloads, random_states(model, [some.payload for some in recorded]))
        if ScaleRemedy.MOTION in remedies:
            return (at_random,)
        return at_random, gain_shares(model, payloads, recorded)


def _remedies(question: _Question, fixed: int) -> dict[tuple[ScaleRemedy, ...], int]:
    """The smallest sets of remedies that fix the most gains, and how many more than are fixed already."""
    possible = question.possible
    reach: dict[tuple[ScaleRemedy, ...], int] = {}
    for size in range(1, len(possible) + 1):
        for chosen in combinations(possible, size):
            if _sensible(chosen, possible):
                determined = np.all([each.determined for each in question.asked(chosen)], axis=0)
                reach[chosen] = int(determined.sum())
        if any(count == len(determined) for count in reach.values()):
            break
    most = max(reach.values(), default=0)
    if most <= fixed:
        return {}
    fewest = min(len(chosen) for chosen, count in reach.items() if count == most)
    return {
        chosen: most - fixed for chosen, count in reach.items() if count == most and len(chosen) == fewest
    }


def _sensible(chosen: Sequence[ScaleRemedy], possible: Sequence[ScaleRemedy]) -> bool:
    """Whether what is declared can be: a centre of mass needs a mass, an inertia both."""
    every = (ScaleRemedy.MASS, ScaleRemedy.CENTER_OF_MASS, ScaleRemedy.INERTIA)
    order = [remedy for remedy in every if remedy in possible]
    declared = [remedy for remedy in order if remedy in chosen]
    return declared == order[: len(declared)]


def _declared(payload: Payload, remedies: Sequence[ScaleRemedy], length: float) -> Payload:
    """The payload with what the remedies declare of it: a ball off the tool, where nothing else is known."""
    ball = assumed(payload, length)
    return Payload(
        payload.name,
        ball.mass if ScaleRemedy.MASS in remedies else payload.mass,
        ball.center_of_mass if ScaleRemedy.CENTER_OF_MASS in remedies else payload.center_of_mass,
        ball.inertia if ScaleRemedy.INERTIA in remedies else payload.inertia,
    )
