"""Search for the motion that best separates two models, inside the limits."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.excitation.bounds import DESIGN, DISCRIMINATION
from bench.excitation.design import Movement, changed, drawn, shrunk, within
from bench.excitation.discrimination.limits import Envelope
from bench.excitation.discrimination.predicted_currents import planned, predicted, times_of
from bench.excitation.discrimination.rival_models import Rival
from bench.excitation.discrimination.separation import Question, Separation, separation
from bench.excitation.limits import feasible_motion
from bench.scenario.trajectory import FourierTrajectory


@dataclass(frozen=True)
class DesignedMotion:
    """A motion, its load, and its separations: one answer for each question."""

    trajectory: FourierTrajectory
    payload: str | None
    answers: tuple[Separation, ...]

    @property
    def nats(self) -> float:
        """The smaller of the answers."""
        return min(answer.nats for answer in self.answers)


def best_motion(
    questions: Sequence[Question],
    envelope: Envelope,
    loads: Sequence[str | None],
    duration: float,
    seed: int,
    progress: Progress = SILENT,
) -> DesignedMotion | None:
    """The motion of `duration` s with the largest evidence, the smallest of its answers; or None."""
    random = np.random.default_rng(seed)
    rivals = tuple({question.truth.request: question.truth for question in questions}.values())
    best: tuple[Movement, DesignedMotion] | None = None
    progress.phase("trying random motions", DISCRIMINATION.starts)
    for i, (movement, trajectory) in enumerate(starts(rivals[0], envelope, duration, random)):
        progress.advance()
        designed = best_loaded(questions, envelope, [loads[i % len(loads)]], trajectory)
        if designed is not None and (best is None or designed.nats > best[1].nats):
            best = movement, designed
    if best is None:
        return None
    movement, design = best
    progress.phase("improving the best motion", DISCRIMINATION.steps)
    for step in range(DISCRIMINATION.steps):
        progress.advance()
        falls = DESIGN.last_spread / DISCRIMINATION.first_spread
        spread = DISCRIMINATION.first_spread * falls ** (step / DISCRIMINATION.steps)
        near, other = _varied(envelope, movement, design.trajectory, spread, random)
        designed = best_loaded(questions, envelope, [design.payload], other)
        if designed is not None and designed.nats > design.nats:
            movement, design = near, designed
    return best_loaded(questions, envelope, loads, design.trajectory) or design


def band_of(envelope: Envelope, trajectory: FourierTrajectory) -> float:
    """The band of a fit to the given data and this motion, Hz."""
    return max(envelope.band, DISCRIMINATION.band * trajectory.harmonics * trajectory.base_frequency)


def starts(
    rival: Rival, envelope: Envelope, duration: float, random: np.random.Generator
) -> Iterator[tuple[Movement, FourierTrajectory]]:
    """Random motions about random centers: fast and slow, of all motors or only one."""
    model = rival.prepared.model
    geometry, limits = model.geometry, envelope.joint
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    n = len(home)
    lowest = DISCRIMINATION.least_periods / duration
    for i in range(DISCRIMINATION.starts):
        harmonics = int(random.choice(DISCRIMINATION.harmonics))
        highest = max(envelope.frequency / harmonics, lowest)
        center = (
            home
            if i % 2
            else home + random.uniform(0.1, 0.7) * (random.uniform(limits.low, limits.high) - home)
        )
        speed = DISCRIMINATION.speeds[i % len(DISCRIMINATION.speeds)] * envelope.velocity
        movement = Movement(
            name="discriminate",
            fitted=True,
            payload=None,
            center=center,
            span=np.maximum(np.minimum(limits.high - center, center - limits.low), DISCRIMINATION.span),
            velocity=speed,
            acceleration=envelope.acceleration,
            harmonics=harmonics,
            base_frequency=float(np.exp(random.uniform(np.log(lowest), np.log(highest)))),
            duration=duration,
            ramp=min(DISCRIMINATION.ramp, duration / 4.0),
            seed=0,
        )
        trajectory = drawn(movement, random)
        if n > 1 and i % 3 == 2:  # one motor alone
            trajectory = trajectory.scaled((np.arange(n) == random.integers(n))[:, None])
        try:
            possible = shrunk(model, limits, movement, trajectory, dense=True).trajectory
        except BenchError:  # no motion fits about this center
            continue
        yield replace(movement, velocity=envelope.velocity), possible


def _varied(
    envelope: Envelope,
    movement: Movement,
    trajectory: FourierTrajectory,
    spread: float,
    random: np.random.Generator,
) -> tuple[Movement, FourierTrajectory]:
    """A motion near another: other coefficients, another size, another center or another period."""
    what = random.integers(4)
    if what == 0:
        trajectory = changed(trajectory, spread, random)
    elif what == 1:
        trajectory = trajectory.scaled(np.exp(2.0 * spread * random.normal(size=(len(trajectory.center), 1))))
    elif what == 2:
        low, high = envelope.joint.low, envelope.joint.high
        center = movement.center + 0.5 * spread * (high - low) * random.normal(size=len(low))
        center = np.clip(center, low + DISCRIMINATION.span, high - DISCRIMINATION.span)
        movement = replace(movement, center=center, span=np.minimum(high - center, center - low))
        trajectory = replace(trajectory, center=center)
    else:
        frequency = movement.base_frequency * float(np.exp(2.0 * spread * random.normal()))
        frequency = min(frequency, envelope.frequency / movement.harmonics)
        frequency = max(frequency, DISCRIMINATION.least_periods / movement.duration)
        movement = replace(movement, base_frequency=frequency)
        trajectory = replace(trajectory, base_frequency=frequency)
    points = DISCRIMINATION.points  # enough at its smooth ends, too
    rate = max(points * trajectory.harmonics * trajectory.base_frequency, points / trajectory.ramp)
    time = np.linspace(0.0, trajectory.duration, int(rate * trajectory.duration) + 2)
    return movement, within(movement, trajectory, time, most=0.999)


def best_loaded(
    questions: Sequence[Question],
    envelope: Envelope,
    loads: Sequence[str | None],
    trajectory: FourierTrajectory,
) -> DesignedMotion | None:
    """The motion with the load that separates best, a payload only if worth it; None outside the limits."""
    first = questions[0].truth
    time = times_of(trajectory, band_of(envelope, trajectory))
    travel = np.ptp(trajectory.evaluate(time)[0], axis=0)
    if np.any((travel > 0.0) & (travel < envelope.stroke)):
        return None
    tree = feasible_motion(first.prepared.model.geometry, envelope.joint, trajectory, time)
    if tree is None:
        return None
    best: DesignedMotion | None = None
    for payload in loads:
        plan = planned(first, trajectory, time, tree, payload)
        currents = {question.truth.request: predicted(question.truth, plan) for question in questions}
        if any(np.any(np.abs(i) > envelope.current) for i in currents.values()):
            continue
        answers = tuple(
            separation(question, plan, currents[question.truth.request]) for question in questions
        )
        designed = DesignedMotion(trajectory, payload, answers)
        factor = DISCRIMINATION.payload_evidence if best is None or best.payload is None else 1.0
        if best is None or designed.nats > factor * best.nats:
            best = designed
    return best
