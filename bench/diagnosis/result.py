"""Result of a diagnosis."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import hypot, inf, log
from typing import TYPE_CHECKING, Literal

from bench.diagnosis.reason import Because, Reason
from bench.effects.select import TAG
from bench.identification.decision import RULE
from bench.identification.frame import data_frame, html_table
from bench.identification.result import CurrentSeries, Identification, Quantity

if TYPE_CHECKING:
    import pandas as pd


class Remainder(StrEnum):
    """The kind of error that remains in the final model."""

    NOISE = "noise"  # of the currents
    NOISE_AND_ENCODERS = "noise and encoders"
    NO_PATTERN = "no pattern"  # more than noise, which varies with no tested variable
    PATTERN = "pattern"


class Unfinished(StrEnum):
    """Parts of the search that the deadline cut or prevented."""

    CAUSES = "causes"  # swapped columns, wrong loads
    SETS = "sets"  # effects of the catalogue, and sets of them, beyond those identified
    OWN_VALUES = "own values"  # what differs from recording to recording
    AS_GOOD = "as good"  # models that explain the data as well
    LAWS = "laws"  # that are in no catalogue


Verdict = Literal["missing", "not supported", "indistinguishable", "resembles", "absorbed"]


@dataclass(frozen=True)
class LadderStep:
    """Errors of the model with these effects, as in `ErrorSummary`, and its currents."""

    effects: tuple[str, ...]
    identify: float | None
    validate: float | None
    recordings: tuple[CurrentSeries, ...] = field(default=(), compare=False, repr=False)

    @property
    def reported(self) -> float | None:
        """The error of recordings that were not fitted; if there are none, of the fitted ones."""
        return self.identify if self.validate is None else self.validate


@dataclass(frozen=True)
class EffectVerdict:
    """What the data say of one effect.

    verdict: indistinguishable always has alternatives; an effect that resembles fits, but leaves much unexplained, or
    is as good as a discovered law. error_before, error_after: relative error on recordings that were not fitted,
    without and with it. evidence: log-likelihood ratio on those recordings, nats. actuators: where it acts.
    alternatives: effects that the data cannot distinguish from it. size: RMS of its torque at each actuator, N*m or N.
    probability: that it acts, if the catalogue contains every effect that acts; None if these data cannot show it, or
    it was not computed. alike: by place, others that the data cannot distinguish from it. places: probability of each
    place, for an effect of the answer.
    """

    effect: str
    verdict: Verdict
    error_before: float
    error_after: float
    evidence: float
    actuators: tuple[str, ...]
    alternatives: tuple[str, ...]
    size: Mapping[str, float]
    why: Reason
    probability: float | None = None
    alike: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    places: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class ProbableSet:
    """Effects that explain the data together: their probability, and the relative error on recordings not fitted."""

    effects: tuple[str, ...]
    probability: float
    error: float


@dataclass(frozen=True)
class WithoutLog:
    """The answer with one log omitted: `gone`, the effects that the other logs do not support. gains: by joint; empty
    if the other logs all carry the same load, which leaves the gains' scale open.
    """

    log: str
    gone: tuple[str, ...]
    gains: Mapping[str, float]


@dataclass(frozen=True)
class Unexplained:
    """The error that the catalogue does not explain. error and noise_floor: relative, on recordings not fitted.

    encoders: relative error by encoder noise, if computed. repeats: the part of the error that does not repeat when the
    motion returns, likewise; None if it never returns or was not computed.
    """

    what: Remainder
    error: float
    noise_floor: float
    depends_on: tuple[str, ...]
    encoders: float = 0.0
    repeats: float | None = None

    @property
    def significant(self) -> bool:
        """Whether something remains that no known effect explains: errors with a pattern, or far more than noise and
        what the logs do not repeat.
        """
        return self.what == Remainder.PATTERN or self.excess > log(RULE.much)

    @property
    def much(self) -> bool:
        """Whether more remains than noise alone can explain, with or without a pattern."""
        return self.error > RULE.much * hypot(self.noise_floor, self.encoders)

    @property
    def excess(self) -> float:
        """Logarithm, at least zero, of the error over noise or the non-repeating part of the error."""
        return excess_of(self.error, self.noise_floor, self.encoders, self.repeats)


def excess_of(error: float, noise_floor: float, encoders: float, repeats: float | None) -> float:
    """See `Unexplained.excess`."""
    floor = max(hypot(noise_floor, encoders), repeats or 0.0)
    return log(max(error / floor, 1.0)) if floor else inf


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
        """Its name in `--with`."""
        return f"{self.effect}:{self.joint}{TAG}"


Role = Literal["direction", "signed", "size", "wave", "decay", "step", "memory", "table"]
"""How a term of a law depends on a variable: on its sign, in proportion, as a power, on its size, ..."""


@dataclass(frozen=True)
class LooksAt:
    """A variable of a law's term; what: such as acceleration; motor: whose, empty for the law's motor or no motor."""

    what: str
    motor: str
    role: Role


@dataclass(frozen=True)
class LawTerm:
    """One term of a law: a formula in SI units, the value of its coefficient, and its variables."""

    term: str
    value: float
    std: float
    unit: str
    looks_at: tuple[LooksAt, ...] = ()


HAT = re.compile(r"hat\((\w+), [^)]*\)")
"""An entry of a table in a term."""


@dataclass(frozen=True)
class Discovered:
    """A law outside the catalogue, at one motor.

    law: the name of its effect. terms: its summands; numbers: their adapted constants, by letter. identify, validate:
    relative errors of the model with it; without: on recordings that were not fitted, without it. named: the
    catalogue's effect of which it is a case. nearest: the effect that best replaces it and its error, None if none
    helps. source: text of its effect's file; file: its path.
    """

    place: str
    law: str
    terms: tuple[LawTerm, ...]
    numbers: Mapping[str, Quantity]
    identify: float | None
    validate: float | None
    without: float | None
    named: str | None
    nearest: tuple[str, float] | None
    source: str = field(repr=False)
    file: str | None = None

    @property
    def formula(self) -> str:
        """The formula of the whole law, in SI units; for a table, its variables."""
        parts = [
            HAT.sub(r"table(\1)", term.term)
            if HAT.search(term.term)
            else f"{term.value:.4g}" + ("" if term.term == "1" else f"*{term.term}")
            for term in self.terms
        ]
        parts = list(dict.fromkeys(parts))
        return " + ".join(parts).replace("+ -", "- ")


@dataclass(frozen=True)
class Superfluous:
    """An effect of the starting model that the result omits; replaced_by: a general one that contains it."""

    effect: str
    replaced_by: str | None


@dataclass(frozen=True, repr=False)
class Diagnosis:
    """The answer of `diagnose`. missing: names, strongest first; before, after: the models without and with them.
    differs: effects with another value in each recording, in the model or not; by_recording: those of which `after` has
    such values; the others have one for all. superfluous: effects of the starting model that `after` omits. discovered:
    laws outside the catalogue, motor by motor; `after` and the ladder have them, too. unfinished: parts of the search
    that the deadline cut. sets: of effects, the most probable first. without_logs: what depends on one of several logs.
    something_else: probability that something outside all models of the search acts.
    """

    robot: str
    held_out: float
    missing: tuple[str, ...]
    ladder: tuple[LadderStep, ...]
    ranking: tuple[EffectVerdict, ...]
    unexplained: Unexplained
    before: Identification
    after: Identification
    differs: tuple[Differing, ...] = ()
    superfluous: tuple[Superfluous, ...] = ()
    discovered: tuple[Discovered, ...] = ()
    unfinished: tuple[Unfinished, ...] = ()
    sets: tuple[ProbableSet, ...] = ()
    without_logs: tuple[WithoutLog, ...] = ()
    something_else: float = 0.0

    @property
    def finished(self) -> bool:
        """Whether the search ended before the deadline."""
        return not self.unfinished

    @property
    def by_recording(self) -> tuple[str, ...]:
        """Effects with a value by recording in `after` but not in `before`, as EFFECT:MOTOR@recording."""
        requests = [differing.request for differing in self.differs]
        return tuple(request for request in requests if request in self.after.effects)

    @property
    def usual(self) -> tuple[str, ...]:
        """Friction in `after` that is not missing: without it, the model is worse than with usual friction."""
        return tuple(verdict.effect for verdict in self.ranking if verdict.why.because is Because.USUAL)

    @property
    def added(self) -> tuple[str, ...]:
        """Names of what `after` adds to `before`: effects of the catalogue, values by recording, and laws."""
        laws = dict.fromkeys(law.law for law in self.discovered)
        return (*self.missing, *self.usual, *self.by_recording, *laws)

    def __repr__(self) -> str:
        parts = (*self.missing, *self.by_recording, *(law.formula for law in self.discovered))
        errors = [step.reported for step in self.ladder]
        fall = " → ".join(f"{100.0 * error:.3g} %" for error in errors if error is not None)
        early = "" if self.finished else "; unfinished"
        return f"<{self.robot}: {', '.join(parts) or 'nothing'} missing; error {fall}{early}>"

    def rows(self) -> list[dict[str, str | float]]:
        """The ranking as a table: one row with effect, verdict, evidence and errors before and after each."""
        return [
            {
                "effect": verdict.effect,
                "verdict": verdict.verdict,
                "evidence": verdict.evidence,
                "error_before": verdict.error_before,
                "error_after": verdict.error_after,
                "at": ", ".join(verdict.actuators),
            }
            for verdict in self.ranking
        ]

    def to_dataframe(self) -> pd.DataFrame:
        """As a data frame. Needs pandas."""
        rows = self.rows()
        return data_frame({name: [row[name] for row in rows] for name in rows[0]})

    def _repr_html_(self) -> str:
        return html_table(repr(self)[1:-1], self.rows())
