"""Result of a search for a telling motion."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.search import DesignedMotion
from bench.excitation.discrimination.separation import Question, Separation
from bench.identification.decision import RULE


@dataclass(frozen=True)
class MotionFacts:
    """One joint: lowest and highest position, largest speed and acceleration, rad or m and s; reversals a second;
    acceleration at reversals, the smaller the slower the joint turns around.
    """

    low: float
    high: float
    speed: float
    acceleration: float
    reversals: float
    turning: float


@dataclass(frozen=True)
class ImpossibleSign:
    """A parameter that must be positive and clearly is not; joint: "" if it belongs to the robot."""

    effect: str
    parameter: str
    joint: str


@dataclass(frozen=True)
class Discrimination:
    """The motion that distinguishes two effects.

    effects: as they were named. error_over_noise: of the better of both models on the given data, RMS over RMS of the
    current noise. shown: nats that each effect explains of the given data. nothing: whether neither shows there and no
    motion promises to show it; then there is no motion. absorbed: effects that the model's parameters absorb, so that
    nothing can show them. imitated: effects that the other imitates for any motion. questions: one for each remaining
    effect, with the answers of the motion; given, promised: nats by the name of the effect assumed to be true.
    recorded, planned: facts by joint. second: mass in kg of a second payload, and the nats that the same motion
    promises with it. wider: factor on the limits, and nats. impossible: signs that the fits to the given data would
    need.
    """

    robot: str
    effects: tuple[str, str]
    error_over_noise: float
    shown: Mapping[str, float]
    nothing: bool
    joints: Mapping[str, str]
    absorbed: tuple[str, ...]
    imitated: tuple[str, ...]
    questions: tuple[Question, ...]
    given_seconds: float
    held_out_rows: int
    motion: DesignedMotion | None
    recorded: Mapping[str, MotionFacts]
    planned: Mapping[str, MotionFacts]
    second: tuple[float, float] | None
    wider: tuple[float, float] | None
    impossible: tuple[ImpossibleSign, ...]

    @property
    def model_is_wrong(self) -> bool:
        """Whether the error is far above the noise with either effect: something else is missing."""
        return self.error_over_noise > DISCRIMINATION.loud

    @property
    def given(self) -> Mapping[str, float]:
        """Expected nats of the given data, by the effect assumed to be true."""
        return {question.truth.request: question.given_nats for question in self.questions}

    @property
    def promised(self) -> Mapping[str, float]:
        """The same of given data and new motion together."""
        answers = () if self.motion is None else self.motion.answers
        return {
            question.truth.request: answer.nats
            for question, answer in zip(self.questions, answers, strict=False)
        }

    @property
    def growth(self) -> float:
        """The share by which the wrong model's error is larger, over given data not fitted and the new motion."""
        if self.motion is None or not self.questions:
            return 0.0
        return _growth(
            (answer.nats, answer, self.held_out_rows + answer.count) for answer in self.motion.answers
        )

    @property
    def given_tells(self) -> bool:
        """Whether the given data suffice."""
        if self.motion is None or not self.questions or self.held_out_rows == 0:
            return False
        pairs = zip(self.given.values(), self.motion.answers, strict=True)
        growth = _growth((nats, answer, self.held_out_rows) for nats, answer in pairs)
        return min(self.given.values()) >= RULE.prior and growth >= RULE.material

    @property
    def tells(self) -> bool:
        """Whether the motion suffices for a verdict of `bench diagnose`."""
        return (
            bool(self.promised) and min(self.promised.values()) >= RULE.prior and self.growth >= RULE.material
        )


def _growth(answers: Iterable[tuple[float, Separation, float]]) -> float:
    """The smallest share by which the wrong model's error is larger, of nats over a number of rows."""
    shares = [2.0 * nats * answer.autocorrelation_time / rows for nats, answer, rows in answers]
    return float(np.sqrt(1.0 + min(shares)) - 1.0)


States = Sequence[np.ndarray]
"""Positions, velocities and accelerations of the motors in a motion, (N, n) each."""


def motion_facts(motions: Sequence[States], seconds: float, joints: Sequence[str]) -> dict[str, MotionFacts]:
    """Facts of motions that last `seconds` together, by joint."""
    return {
        joint: _facts([[state[:, j] for state in states] for states in motions], seconds)
        for j, joint in enumerate(joints)
    }


def _facts(motions: Sequence[States], seconds: float) -> MotionFacts:
    position, speed, acceleration = ([states[order] for states in motions] for order in range(3))
    fastest = max(float(np.abs(values).max()) for values in speed)
    count, turning = 0, []
    for v, a in zip(speed, acceleration, strict=True):
        fast = np.flatnonzero(np.abs(v) > DISCRIMINATION.slow * fastest)
        turns = fast[:-1][np.diff(np.sign(v[fast])) != 0]
        count += len(turns)
        turning += np.abs(a[turns]).tolist()
    return MotionFacts(
        low=min(float(values.min()) for values in position),
        high=max(float(values.max()) for values in position),
        speed=fastest,
        acceleration=max(float(np.abs(values).max()) for values in acceleration),
        reversals=count / seconds,
        turning=float(np.median(turning)) if turning else 0.0,
    )
