"""What a diagnosis says."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from bench.effects.select import TAG
from bench.estimate.result import CurrentSeries, Identification, Quantity

Verdict = Literal["missing", "not supported", "indistinguishable", "resembles", "absorbed"]


@dataclass(frozen=True)
class LadderStep:
    """Errors of the model with these effects, as in `ErrorSummary`, and the currents that it gives."""

    effects: tuple[str, ...]
    identify: float | None
    validate: float | None
    recordings: tuple[CurrentSeries, ...] = field(default=(), compare=False, repr=False)


@dataclass(frozen=True)
class EffectVerdict:
    """What the data say of one effect.

    verdict: indistinguishable always has alternatives; an effect that resembles what is missing fits, and leaves much
    that no effect explains.
    error_before, error_after: relative error on recordings that were not fitted, without and with it. evidence:
    log-likelihood ratio on those recordings, nats. actuators: where it shows. alternatives: effects that the data
    cannot tell from it. size: RMS of its torque at each actuator, N*m or N.
    """

    effect: str
    verdict: Verdict
    error_before: float
    error_after: float
    evidence: float
    actuators: tuple[str, ...]
    alternatives: tuple[str, ...]
    size: Mapping[str, float]
    why: str


@dataclass(frozen=True)
class Unexplained:
    """What no effect of the catalogue accounts for. error and noise_floor: relative, on recordings not fitted."""

    significant: bool
    error: float
    noise_floor: float
    depends_on: tuple[str, ...]
    why: str


@dataclass(frozen=True)
class Differing:
    """An effect at a motor whose value differs from recording to recording.

    values: by recording, of its one parameter. evidence: log-likelihood ratio on parts of the recordings that were not
    fitted, nats; error_before, error_after: of that motor's current there, relative, with one value for all recordings
    and with one for each.
    """

    effect: str
    joint: str
    values: Mapping[str, Quantity]
    evidence: float
    error_before: float
    error_after: float

    @property
    def request(self) -> str:
        """How it is added to a model."""
        return f"{self.effect}:{self.joint}{TAG}"


@dataclass(frozen=True)
class Superfluous:
    """An effect of the starting model that what was found does without; replaced_by: one of these that contains it."""

    effect: str
    replaced_by: str | None


@dataclass(frozen=True)
class Diagnosis:
    """The answer of `diagnose`. missing: names, strongest first; before, after: the models without and with
    them. differs: what has another value in each recording, whether the model has it or not; `after` has one for all.
    superfluous: effects of the starting model that `after` does without.
    """

    robot: str
    split: str
    missing: tuple[str, ...]
    ladder: tuple[LadderStep, ...]
    ranking: tuple[EffectVerdict, ...]
    unexplained: Unexplained
    before: Identification
    after: Identification
    differs: tuple[Differing, ...] = ()
    superfluous: tuple[Superfluous, ...] = ()
