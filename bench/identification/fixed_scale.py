"""Whether payloads fix the drive gains, and what would fix the others.

Without a known load all gains, base parameters and payload parameters can grow together. A payload of known mass fixes
that scale only if no unknown can imitate its known torque: if the body turns about a fixed point, its unknown first
moments and inertia can. Decided by geometry and motion, never by noise.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from bench.dataset.payload import Payload
from bench.identification.layout import parameter_layout, payload_columns
from bench.identification.observation import Observation
from bench.identification.scale import Scale, ScaleCase, ScaleRemedy
from bench.identification.tolerances import TOLERANCES
from bench.model.bounds import BODIES, RANKS
from bench.model.geometry import Geometry, Placement
from bench.model.model import IdentificationModel
from bench.model.regressor import payload_transform

SEED = 20120604  # of the currents of redundant motors at the random states
# unit length, along no axis of a tool: assumed direction of an unknown centre
ASIDE = np.array([0.6, -0.48, 0.64])


@dataclass(frozen=True)
class LoadedStates:
    """States of a robot with one load: the torque (s, n, ...), N*m or N, of each unit of the base parameters (nb), of
    the payload's standard parameters in the tool frame (10) and of the redundant motors' gains (r).
    """

    payload: str | None
    rigid: np.ndarray
    loads: np.ndarray | None
    redundant: np.ndarray


@dataclass(frozen=True)
class GainShares:
    """shares (r + n,): the part of every motor's torque that only its gain explains, redundant motors first.

    columns (R, K): those of all unknowns, the gains last and for relative changes. If a share is zero, the gain and
    other unknowns can change together without changing any torque.
    """

    shares: np.ndarray
    columns: np.ndarray

    @property
    def determined(self) -> np.ndarray:
        """Which gains are, (r + n,)."""
        return np.asarray(self.shares > RANKS.slack)

    def apart(self, held: np.ndarray) -> bool:
        """Whether the other gains do not depend on the values of the held ones, (r + n,) True or False."""
        others = self.columns.shape[1] - len(held)
        free = np.append(np.ones(others, dtype=bool), ~held)
        combinations = np.linalg.lstsq(self.columns[:, free], self.columns[:, ~free])[0]
        return bool(np.abs(combinations[others:]).max(initial=0.0) < RANKS.slack)


def gain_shares(
    model: IdentificationModel, payloads: Mapping[str, Payload], states: Sequence[LoadedStates]
) -> GainShares:
    """With the gains unknown, equation 13 of these states without its last column, the known payload's torque.

    Masses are guessed, and a payload weighs as much as a body of the robot: its mass does not affect the rank.
    """
    geometry = model.geometry
    carried = dict.fromkeys(some.payload for some in states if some.payload is not None)
    loads = {name: _as_heavy_as_a_body(payloads[name]) for name in carried}
    layout = parameter_layout(model, loads, list(loads), 0)
    actual = {
        name: payload_columns(assumed(load, robot_length(geometry))).known for name, load in loads.items()
    }
    extra = np.array([actuator.gain for actuator in geometry.robot.redundant])
    n, r = len(geometry.active), len(extra)
    size, blocks = layout.size + r + n, []
    for some in states:
        block = np.zeros((len(some.rigid), n, size))
        block[:, :, : layout.base] = some.rigid
        block[:, :, layout.size : layout.size + r] = some.redundant * extra
        torque = some.rigid @ model.guessed + some.redundant @ extra
        if some.payload is not None and some.loads is not None:
            index = layout.payloads[some.payload]
            block[:, :, layout.payload_slice(some.payload)] = some.loads[:, :, index]
            torque = torque + some.loads @ actual[some.payload]
        block[:, np.arange(n), layout.size + r + np.arange(n)] = -torque
        blocks.append(block.reshape(-1, block.shape[2]))
    triangle = np.asarray(np.linalg.qr(np.vstack((*blocks, np.zeros((size, size)))), mode="r"))
    lengths = np.linalg.norm(triangle, axis=0)
    lengths[lengths == 0.0] = 1.0
    unit = triangle / lengths
    _, singular, vectors = np.linalg.svd(unit)
    least = np.finfo(float).eps * singular.max(initial=1.0)
    inverse = np.sqrt(((vectors / np.maximum(singular, least)[:, None]) ** 2).sum(axis=0))
    shares = np.where(np.linalg.norm(unit, axis=0) > 0.0, 1.0 / inverse, 0.0)[layout.size :]
    unit[:, layout.size :] = triangle[:, layout.size :]
    return GainShares(shares, unit)


def random_states(model: IdentificationModel, loaded: Sequence[str | None]) -> list[LoadedStates]:
    """The model's random states with every load; redundant motors have random currents there.

    States are scaled to equal torque: those near a singular pose would outweigh all others.
    """
    rigid, loads = model.random_rows
    redundant = model.random_redundant
    currents = np.random.default_rng(SEED).normal(size=redundant.shape[::2])
    torque = np.linalg.norm(rigid @ model.guessed, axis=1)
    scale = 1.0 / np.where(torque > 0.0, torque, 1.0)[:, None, None]
    parts = rigid * scale, loads * scale, redundant * currents[:, None] * scale
    return [LoadedStates(name, *parts) for name in dict.fromkeys(loaded)]


def recorded_states(observations: Sequence[Observation]) -> list[LoadedStates]:
    """Some rows of every recording, where the joints move."""
    states = []
    for observation in observations:
        some = slice(None, None, 1 + len(observation.time) // TOLERANCES.memory.rank_rows)
        moving = observation.moving[some, :, None]
        loads = None if observation.payload is None else observation.payload[some] * moving
        parts = observation.rigid[some] * moving, loads, observation.redundant[some] * moving
        states.append(LoadedStates(observation.payload_name, *parts))
    return states


def robot_length(geometry: Geometry) -> float:
    """The largest distance from a joint to the next or to the tool, m."""
    placements = [joint.placement for joint in geometry.joints]
    if geometry.tool is not None:
        placements.append(geometry.tool.placement)
    return max(BODIES.shortest, *(float(np.linalg.norm(placement.translation)) for placement in placements))


def _as_heavy_as_a_body(payload: Payload) -> Payload:
    if payload.mass is None:
        return payload
    inertia = None if payload.inertia is None else payload.inertia * (BODIES.mass / payload.mass)
    return replace(payload, mass=BODIES.mass, inertia=inertia)


def assumed(payload: Payload, length: float) -> Payload:
    """The payload with values for what is not declared: a ball off the tool; length: the robot's, m."""
    mass = BODIES.mass if payload.mass is None else payload.mass
    ball = mass * (TOLERANCES.motion.gyration * length) ** 2 * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    center = (
        TOLERANCES.motion.centre * length * ASIDE
        if payload.center_of_mass is None
        else payload.center_of_mass
    )
    return Payload(payload.name, mass, center, ball if payload.inertia is None else payload.inertia)


# unit length, along no axis of a tool: towards a payload fixed elsewhere
AWAY = np.array([0.48, 0.64, -0.6])


def scale_of(
    model: IdentificationModel, payloads: Mapping[str, Payload], recorded: Sequence[LoadedStates]
) -> Scale:
    """The gains that payloads fix, at random states of the robot and at the recorded ones, one entry per recording.

    Fixed gains are fitted if the others, held at nominal values, do not move them; redundant motors' gains are held
    with all others or not at all.
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
    # states that determine all gains say nothing about gains that a recorded motion leaves open
    if some and all(each.apart(~determined) for each in shares if not each.determined.all()):
        return Scale(ScaleCase.FIXED_FOR_SOME, names, open_, open_, remedies)
    return Scale(ScaleCase.NOT_FIXED, names, open_, joints, remedies)


@dataclass(frozen=True)
class _Question:
    """A robot's fitted recordings and payloads, to be examined with remedies for all payloads."""

    model: IdentificationModel
    payloads: Mapping[str, Payload]
    recorded: Sequence[LoadedStates]

    @cached_property
    def length(self) -> float:
        """The robot's, m."""
        return robot_length(self.model.geometry)

    @cached_property
    def elsewhere(self) -> tuple[IdentificationModel, Sequence[LoadedStates]]:
        """The model and the recorded states, with payloads a robot's length off the tool."""
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
        """Remedies that apply."""
        loads = self.payloads.values()
        missing = {
            ScaleRemedy.MASS: any(payload.mass is None for payload in loads),
            ScaleRemedy.CENTER_OF_MASS: any(payload.center_of_mass is None for payload in loads),
            ScaleRemedy.INERTIA: any(payload.inertia is None for payload in loads),
            ScaleRemedy.UNLOADED: all(some.payload is not None for some in self.recorded),
        }
        return tuple(remedy for remedy in ScaleRemedy if missing.get(remedy, True))

    def asked(self, remedies: Sequence[ScaleRemedy]) -> tuple[GainShares, ...]:
        """Shares at random states and, unless a remedy is motion, at recorded ones."""
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
    """Whether declarations make sense: a centre of mass needs a mass, an inertia both."""
    every = (ScaleRemedy.MASS, ScaleRemedy.CENTER_OF_MASS, ScaleRemedy.INERTIA)
    order = [remedy for remedy in every if remedy in possible]
    declared = [remedy for remedy in order if remedy in chosen]
    return declared == order[: len(declared)]


def _declared(payload: Payload, remedies: Sequence[ScaleRemedy], length: float) -> Payload:
    """The payload with what the remedies declare: a ball off the tool where nothing else is known."""
    ball = assumed(payload, length)
    return Payload(
        payload.name,
        ball.mass if ScaleRemedy.MASS in remedies else payload.mass,
        ball.center_of_mass if ScaleRemedy.CENTER_OF_MASS in remedies else payload.center_of_mass,
        ball.inertia if ScaleRemedy.INERTIA in remedies else payload.inertia,
    )
