"""Search for the motions that make standard errors small, inside all limits."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.excitation.experiment.nominal import Equations, Evidence, Nominal, equations, evidence, seen
from bench.excitation.experiment.room import (
    Room,
    between,
    filled,
    fine_times,
    keeps_joints,
    robot_motion,
)
from bench.model.motion import Motion
from bench.scenario.trajectory import FourierTrajectory, random_trajectory

RANDOM = 50  # motions at random; the best few of them are improved
ROUNDS = ((8, 0.32), (4, 0.24), (2, 0.2), (1, 0.24))  # how many go on, and their share of the steps together
TRIES = 20  # of a random motion, until one keeps the limits at some size
SHRINK = 0.9
MOST_SHRINKS = 40
FIRST_SPREAD, LAST_SPREAD = 0.5, 0.02  # of a change, relative to a coefficient's size
FEW = 3  # harmonics for each joint of a sparse motion
POINTS = 8.0  # samples of a period of the highest harmonic, in the search
FEWEST_POINTS = 20  # of a ramp


@dataclass(frozen=True)
class Shape:
    """What all motions of an experiment have in common: Hz and s. lowest, highest: of the base frequencies that the
    search may try, Hz.
    """

    harmonics: int
    base_frequency: float
    lowest: float
    highest: float
    duration: float
    ramp: float

    @property
    def times(self) -> np.ndarray:
        """When a motion is looked at in the search, (N,) s."""
        rate = max(POINTS * self.harmonics * self.highest, FEWEST_POINTS / self.ramp)
        return np.linspace(0.0, self.duration, int(np.ceil(rate * self.duration)) + 1)


@dataclass(frozen=True)
class Tried:
    """A trajectory that keeps the limits, with its motion and what it tells."""

    trajectory: FourierTrajectory
    motion: Motion
    evidence: Evidence


Candidate = tuple[Tried, ...]  # one for each recording
Criterion = Callable[[Equations], float]
"""What is made small, of the fit of all recordings together."""


@dataclass(frozen=True)
class Search:
    """Everything that a search needs. loads: the payload of every recording, or None; known: what
    recordings tell that are there already.
    """

    nominal: Nominal
    room: Room
    shape: Shape
    loads: tuple[str | None, ...]
    known: tuple[Evidence, ...]
    criterion: Criterion

    def value(self, candidate: Sequence[Tried]) -> float:
        """The criterion of some motions."""
        return self.criterion(self.fit(candidate))

    def fit(self, candidate: Sequence[Tried]) -> Equations:
        """The equations of some motions, with all that is known already."""
        return equations([*self.known, *(trial.evidence for trial in candidate)])

    def tried(
        self, trajectory: FourierTrajectory, load: str | None, near: Motion | None = None
    ) -> Tried | None:
        """A trajectory with what it tells; None where it does not keep the limits."""
        geometry = self.nominal.model.geometry
        motion = robot_motion(geometry, self.room, trajectory, self.shape.times, near=near)
        if motion is None:
            return None
        what = seen(self.nominal, motion, load)
        if np.any(np.abs(what.current * self.nominal.gains) > self.room.torque):
            return None
        return Tried(trajectory, motion, evidence(self.nominal, what, self.shape.duration))

    def shrunk(self, trajectory: FourierTrajectory, load: str | None) -> Tried | None:
        """The same motion, smaller, until it keeps the limits; None if it never does."""
        for _ in range(MOST_SHRINKS):
            found = self.tried(trajectory, load)
            if found is not None:
                return found
            trajectory = scaled(trajectory, SHRINK)
        return None


def scaled(trajectory: FourierTrajectory, factor: float) -> FourierTrajectory:
    """The motion about home times a factor."""
    return replace(trajectory, a=trajectory.a * factor, b=trajectory.b * factor)


def random_candidates(
    search: Search, count: int, seed: int, *, few: bool = False, progress: Progress = SILENT
) -> list[Candidate]:
    """Motions with random coefficients, each as large as its limits allow. Raises BenchError where none keeps them.

    few: with few harmonics for each joint, and a base frequency at random.
    """
    random = np.random.default_rng([seed, int(few)])
    shape, room = search.shape, search.room
    found = []
    for _ in range(count):
        progress.advance()
        candidate: list[Tried] = []
        frequency = shape.base_frequency
        if few:
            frequency = float(np.exp(random.uniform(np.log(shape.lowest), np.log(shape.highest))))
        for load in search.loads:
            for _ in range(TRIES):
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
                    drawn = _with_few(drawn, random)
                shrunk = search.shrunk(filled(room, drawn, grow=True), load)
                if shrunk is not None:
                    candidate.append(shrunk)
                    break
            else:
                raise BenchError(
                    f"robot {search.nominal.model.geometry.robot.name}: no motion from home keeps all limits, however "
                    "small: they leave no room"
                )
        found.append(tuple(candidate))
    return found


def _with_few(trajectory: FourierTrajectory, random: np.random.Generator) -> FourierTrajectory:
    """The same with FEW harmonics left for each joint."""
    kept = random.random(trajectory.a.shape).argsort(axis=1) < FEW
    return replace(trajectory, a=trajectory.a * kept, b=trajectory.b * kept)


def improved(
    search: Search, start: Candidate, steps: int, random: np.random.Generator, progress: Progress = SILENT
) -> Candidate:
    """Random changes of one recording after the other, kept where they are better."""
    best, lowest = start, search.value(start)
    spread = FIRST_SPREAD
    for step in range(steps):
        progress.advance()
        which = step % len(best)
        before = best[which]
        trajectory = filled(search.room, _changed(before.trajectory, search.shape, spread, random))
        found = search.tried(trajectory, search.loads[which], before.motion)
        better = False
        if found is not None:
            candidate = (*best[:which], found, *best[which + 1 :])
            value = search.value(candidate)
            better = value < lowest
            if better:
                best, lowest = candidate, value
        # as many steps succeed as an evolution strategy needs: one in five (Rechenberg 1973)
        spread = float(np.clip(spread * np.exp(0.2 if better else -0.05), LAST_SPREAD, 1.0))
    return best


def _changed(
    trajectory: FourierTrajectory, shape: Shape, spread: float, random: np.random.Generator
) -> FourierTrajectory:
    """Other coefficients, of all joints or of one, another size of one joint, or another base frequency."""
    a, b = trajectory.a.copy(), trajectory.b.copy()
    n, harmonics = a.shape
    what = int(random.integers(5))
    if what == 4:
        frequency = trajectory.base_frequency * float(np.exp(0.3 * spread * random.normal()))
        return replace(trajectory, base_frequency=float(np.clip(frequency, shape.lowest, shape.highest)))
    joints = np.ones(n, dtype=bool) if what == 0 else np.arange(n) == random.integers(n)
    if what == 3:
        factor = np.exp(spread * random.normal())
        a[joints] *= factor
        b[joints] *= factor
        return replace(trajectory, a=a, b=b)
    kept = np.ones(harmonics, dtype=bool) if what < 2 else np.arange(harmonics) == random.integers(harmonics)
    k = np.arange(1, harmonics + 1)
    own = np.sqrt(np.mean((a**2 + b**2) * k**2, axis=1, keepdims=True))  # the share of the speed
    size = spread * own / k * joints[:, None] * kept
    a += size * random.normal(size=a.shape)
    b += size * random.normal(size=b.shape)
    return replace(trajectory, a=a, b=b)


def best_candidate(
    search: Search, starts: Sequence[Candidate], steps: int, seed: int, progress: Progress = SILENT
) -> Candidate:
    """The best of the starts, improved in rounds: fewer go on to each, with more steps for each of them (successive
    halving, Jamieson and Talwalkar 2016), since how good a start is does not tell how far it comes.
    """
    random = np.random.default_rng([seed, 2])
    pool = list(starts)
    for count, share in ROUNDS:
        pool = sorted(pool, key=search.value)[:count]
        each = int(share * steps / len(pool))
        pool = [improved(search, candidate, each, random, progress) for candidate in pool]
    return min(pool, key=search.value)


def proven(search: Search, candidate: Candidate) -> dict[int, Tried]:
    """Each motion, shrunk until it keeps every limit between samples, too, by its recording's number."""
    geometry, room = search.nominal.model.geometry, search.room
    kept: dict[int, Tried] = {}
    for number, (trial, load) in enumerate(zip(candidate, search.loads, strict=True)):
        trajectory = filled(room, trial.trajectory)
        for _ in range(MOST_SHRINKS):
            time = fine_times(trajectory)
            motion = robot_motion(geometry, room, trajectory, time, dense=True)
            if motion is not None and _keeps_torque(search, motion, load):
                found = search.tried(trajectory, load)
                if found is not None and keeps_joints(room, trajectory):
                    kept[number] = found
                    break
            trajectory = scaled(trajectory, 1.0 - 0.2 * (1.0 - SHRINK))
        else:
            raise BenchError(
                f"robot {geometry.robot.name}: no motion from home keeps all limits between samples"
            )
    return kept


def _keeps_torque(search: Search, motion: Motion, load: str | None) -> bool:
    if not np.isfinite(search.room.torque).any():
        return True
    torque = seen(search.nominal, motion, load).current * search.nominal.gains
    return bool(np.all(np.abs(torque) + between(torque) <= search.room.torque))


def random_values(search: Search, candidates: Sequence[Candidate]) -> Mapping[str, float]:
    """The criterion of random motions: best and median."""
    values = sorted(search.value(candidate) for candidate in candidates)
    return {"best": values[0], "median": float(np.median(values))}
