"""Search for the motions that minimise standard errors, inside all limits."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.joint_units import drive_unit
from bench.basics.mapper import IN_TURN, Mapper
from bench.basics.progress import SILENT, Progress
from bench.excitation.bounds import DESIGN, SEARCH
from bench.excitation.current_band import band_shares
from bench.excitation.experiment.covariance import Errors
from bench.excitation.experiment.nominal import Equations, Evidence, Nominal, equations, evidence, seen
from bench.excitation.experiment.proof import Promise, Proof, Unproven, prove
from bench.excitation.experiment.proof_words import refused
from bench.excitation.experiment.room import Room, filled, keeps_joints, robot_motion
from bench.model.motion import Motion, motion_of
from bench.scenario.trajectory import FourierTrajectory, random_trajectory


@dataclass(frozen=True)
class Shape:
    """Common properties of all motions of an experiment: Hz and s. lowest, highest: base frequencies that the search
    may try, Hz.
    """

    harmonics: int
    base_frequency: float
    lowest: float
    highest: float
    duration: float
    ramp: float

    @property
    def times(self) -> np.ndarray:
        """Times of a motion in the search, (N,) s."""
        rate = max(SEARCH.points * self.harmonics * self.highest, SEARCH.ramp_points / self.ramp)
        return np.linspace(0.0, self.duration, int(np.ceil(rate * self.duration)) + 1)

    @property
    def rate(self) -> float:
        """The rate of `times`, Hz."""
        return (len(self.times) - 1) / self.duration


@dataclass(frozen=True)
class Tried:
    """A trajectory that keeps the limits, with its motion and information."""

    trajectory: FourierTrajectory
    motion: Motion
    evidence: Evidence


Candidate = tuple[Tried, ...]  # one for each recording


@dataclass(frozen=True)
class Search:
    """Everything that a search needs. loads: the payload of every recording, or None; known: information of existing
    recordings.
    """

    nominal: Nominal
    room: Room
    shape: Shape
    loads: tuple[str | None, ...]
    known: tuple[Evidence, ...]
    errors: Errors

    def value(self, candidate: Sequence[Tried]) -> float:
        """The criterion of some motions: the largest value to minimise."""
        return largest_of(self.errors, self.fit(candidate))

    def fit(self, candidate: Sequence[Tried]) -> Equations:
        """The equations of some motions and the existing recordings."""
        return equations([*self.known, *(trial.evidence for trial in candidate)])

    def tried(
        self, trajectory: FourierTrajectory, load: str | None, near: Motion | None = None
    ) -> Tried | None:
        """A trajectory with its information; None if it violates the limits."""
        motion = self._motion(trajectory, near)
        return None if motion is None else self._telling(trajectory, load, motion)

    def shrunk(self, trajectory: FourierTrajectory, load: str | None) -> Tried | None:
        """The same motion, smaller, until it keeps the limits; None if it never does."""
        near = None
        for _ in range(SEARCH.shrinks):
            motion = self._motion(trajectory, near)
            kept = None if motion is None else self._telling(trajectory, load, motion)
            if kept is not None:
                return kept
            near = motion
            trajectory = trajectory.scaled(DESIGN.shrink)
        return None

    def _motion(self, trajectory: FourierTrajectory, near: Motion | None) -> Motion | None:
        return robot_motion(self.nominal.model.geometry, self.room, trajectory, self.shape.times, near=near)

    def _telling(self, trajectory: FourierTrajectory, load: str | None, motion: Motion) -> Tried | None:
        """Information of a motion; None if its currents violate their limits or their band."""
        what = seen(self.nominal, motion, load)
        if np.any(np.abs(what.current * self.nominal.gains) > self.room.torque):
            return None
        if np.any(band_shares(what.current, self.shape.rate, trajectory) > 1.0):
            return None
        return Tried(trajectory, motion, evidence(self.nominal, what, self.shape.duration))


def check_standing(search: Search) -> None:
    """Raise BenchError naming the motor whose torque is too small to hold the robot at home."""
    nominal, room = replace(search.nominal, effects=()), search.room
    rest = np.zeros((1, len(room.home)))
    at_home = motion_of(nominal.model.geometry, np.zeros(1), room.home[None], rest, rest)
    for load in search.loads:
        current = np.abs(seen(nominal, at_home, load).current[0])
        allowed = room.torque / nominal.gains
        for actuator, needed, most in zip(
            nominal.model.geometry.robot.actuators, current, allowed, strict=True
        ):
            if needed > most:
                unit = drive_unit(actuator.gain_unit)
                carrying = "" if load is None else " with the payload"
                raise BenchError(
                    f"current or torque of {actuator.joint}: {most:.3g} {unit} leaves no room, "
                    f"standing at home{carrying} takes {needed:.3g} already"
                )


def check_proven_at_home(search: Search) -> None:
    """Raise BenchError if a limit cannot be proven at rest at home, where every motion begins."""
    none = np.zeros((len(search.room.home), 1))
    standing = FourierTrajectory(
        search.room.home, none, none, 1.0 / SEARCH.standing, SEARCH.standing, 0.5 * SEARCH.standing
    )
    for load in search.loads:
        proof = prove(Promise(search.nominal, search.room, standing, load))
        if isinstance(proof, Unproven):
            raise _none_proven(search, refused(replace(proof, time=None)))


def _none_proven(search: Search, kept: str) -> BenchError:
    robot = search.nominal.model.geometry.robot.name
    return BenchError(f"robot {robot}: of no motion from home it could be proven that it keeps {kept}")


def largest_of(errors: Errors, fit: Equations) -> float:
    """The criterion of a fit."""
    return float(np.exp(errors(fit).max()))


@dataclass(frozen=True)
class _Drawn:
    """Random trajectories, one for each recording; seed: of others, if one violates limits at every size."""

    trajectories: tuple[FourierTrajectory, ...]
    few: bool
    seed: tuple[int, ...]


def random_candidates(
    search: Search,
    count: int,
    seed: int,
    *,
    few: bool = False,
    stream: int = 0,
    mapper: Mapper = IN_TURN,
    progress: Progress = SILENT,
) -> list[Candidate]:
    """Motions with random coefficients, each as large as its limits allow. Raises BenchError if none keeps them.

    few: with few harmonics for each joint, and a random base frequency. stream: an even number; motions of different
    streams are independent.
    """
    random = np.random.default_rng([seed, stream + int(few)])
    shape = search.shape
    drawn = []
    for number in range(count):
        frequency = shape.base_frequency
        if few:
            frequency = float(np.exp(random.uniform(np.log(shape.lowest), np.log(shape.highest))))
        trajectories = tuple(_drawn(search, frequency, few, random) for _ in search.loads)
        drawn.append(_Drawn(trajectories, few, (seed, stream + int(few), number)))
    candidates = []
    for candidate in mapper.map(_largest, search, drawn):
        progress.advance()
        candidates.append(candidate)
    return candidates


def _drawn(search: Search, frequency: float, few: bool, random: np.random.Generator) -> FourierTrajectory:
    """A random trajectory."""
    shape, room = search.shape, search.room
    drawn = random_trajectory(
        int(random.integers(2**31)),
        room.home,
        room.joint.high - room.joint.low,
        room.velocity,
        acceleration_limit=room.acceleration,
        harmonics=shape.harmonics,
        base_frequency=frequency,
        duration=shape.duration,
        ramp=shape.ramp,
    )
    if few:
        drawn = drawn.scaled(random.random(drawn.a.shape).argsort(axis=1) < SEARCH.sparse_harmonics)
    return drawn


def _largest(search: Search, drawn: _Drawn) -> Candidate:
    """The drawn motions, or random others, as large as the limits allow."""
    random = np.random.default_rng(drawn.seed)
    motions: list[Tried] = []
    for first, load in zip(drawn.trajectories, search.loads, strict=True):
        trajectory = first
        for _ in range(SEARCH.tries):
            full = filled(search.room, trajectory, grow=True)
            shrunk = search.shrunk(full, load)
            if shrunk is not None:
                motions.append(shrunk)
                break
            trajectory = _drawn(search, first.base_frequency, drawn.few, random)
        else:
            raise _no_room(search, full.scaled(DESIGN.shrink ** (SEARCH.shrinks - 1)), load)
    return tuple(motions)


def _no_room(search: Search, smallest: FourierTrajectory, load: str | None) -> BenchError:
    """Message if no motion keeps the limits: the limit that the smallest one violates."""
    said = "no motion from home keeps all limits, however small: they leave no room"
    proof = prove(Promise(search.nominal, search.room, smallest, load))
    if isinstance(proof, Unproven):
        said += f"; the smallest that was tried does not keep {refused(proof)}"
    return BenchError(f"robot {search.nominal.model.geometry.robot.name}: {said}")


@dataclass(frozen=True)
class Proven:
    """A motion that keeps every limit at all times, by its proof; given_way: failed proofs of larger ones."""

    tried: Tried
    proof: Proof
    given_way: tuple[Unproven, ...] = ()


def all_proven(
    search: Search, motions: Sequence[tuple[Tried, str | None]], mapper: Mapper = IN_TURN
) -> tuple[Proven, ...]:
    """Motions with their payloads, each shrunk until a proof that it keeps every limit at all times. Raises BenchError
    naming the limit that leaves no room.
    """
    return tuple(mapper.map(_proven, search, motions))


def _proven(search: Search, motion: tuple[Tried, str | None]) -> Proven:
    trial, load = motion
    given_way: list[Unproven] = []
    trajectory = filled(search.room, trial.trajectory)
    less = 0.2 * (1.0 - DESIGN.shrink)
    for attempt in range(SEARCH.shrinks):
        promise = Promise(search.nominal, search.room, trajectory, load)
        proof = proven_near(promise, given_way[-1].time if given_way else None)
        if isinstance(proof, Unproven):
            given_way.append(proof)
        else:
            kept = search.tried(trajectory, load)
            if kept is not None and keeps_joints(search.room, trajectory):
                return Proven(kept, proof, tuple(given_way))
        less = less if attempt < SEARCH.small_shrinks else min(2.0 * less, 1.0 - DESIGN.shrink)
        trajectory = trajectory.scaled(1.0 - less)
    raise _none_proven(search, refused(given_way[-1]) if given_way else "all limits")


def proven_near(promise: Promise, failed: float | None) -> Proof | Unproven:
    """Proof of a motion, or its failure. failed, s: the time at which a larger motion failed; it is examined first,
    since a failure there saves the proof of the whole motion.
    """
    if failed is not None and isinstance(there := prove(promise, around=failed), Unproven):
        return there
    return prove(promise)
