"""The questions of the evaluation: which cases count, which answers are right, and the required shares."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from bench.studies.sweep.journal import OK, Row
from bench.studies.trial.cases import Kind
from bench.studies.trial.summary import LARGE, alarm, honest
from bench.studies.trial.target import Share, Target, TargetFigure
from bench.studies.trial.unknown_page import at_floor

Judge = Callable[[Row], bool]


@dataclass(frozen=True)
class TrustQuestion:
    """A question about cases of one kind.

    event: what is counted; its share must be at least `least`, or at most `most`. planned: number of cases.
    """

    kind: Kind
    title: str
    figure: TargetFigure
    event: Judge
    planned: int
    least: float | None = None
    most: float | None = None

    def counts(self, row: Row) -> bool:
        """Whether the case can be judged: it has an answer, and every hidden effect is visible in the error."""
        if row["status"] != OK:
            return False
        return self.kind == "nothing" or (not row["absorbed"] and row["least_own_error_over_floor"] >= LARGE)

    def wrong(self, row: Row) -> bool:
        """Whether a case that counts has the wrong answer."""
        return self.event(row) == (self.most is not None)

    def target(self, rows: Sequence[Row]) -> Target:
        """The share of the event in the rows that count, with its bounds."""
        counted = [row for row in rows if self.counts(row)]
        share = Share(sum(self.event(row) for row in counted), len(counted))
        return Target(self.figure, share.value, self.least, self.most, share)

    @property
    def ideal(self) -> Share:
        """The share if all planned cases are right."""
        return Share(0 if self.most is not None else self.planned, self.planned)


def _law(row: Row) -> bool:
    """Whether the law is modelled down to the noise, and no effect is named that is absent."""
    return at_floor(row) and not row["wrong"]


def _has(column: str) -> Judge:
    """A judge that is true if a row's column is."""
    return lambda row: bool(row[column])


QUESTIONS: Mapping[Kind, TrustQuestion] = {
    question.kind: question
    for question in (
        TrustQuestion("nothing", "nothing hidden: any alarm", TargetFigure.ALARM, alarm, 100, most=0.02),
        TrustQuestion(
            "one", "one effect: named first", TargetFigure.ONE_FIRST, _has("first"), 60, least=0.95
        ),
        TrustQuestion("two", "two: the set exactly", TargetFigure.TWO_EXACT, _has("exact"), 40, least=0.85),
        TrustQuestion(
            "three", "three: the set exactly", TargetFigure.THREE_EXACT, _has("exact"), 20, least=0.7
        ),
        TrustQuestion(
            "unknown",
            "law in no catalogue: at the noise, no wrong name",
            TargetFigure.UNKNOWN_LAW,
            _law,
            30,
            least=0.80,
        ),
        TrustQuestion(
            "outside",
            "outside: a law or unexplained, no wrong name",
            TargetFigure.OUTSIDE_HONEST,
            honest,
            20,
            least=0.90,
        ),
    )
}
"""Questions by kind of case. For single effects there are two cases for each effect that the robot can have."""

MANY_WITH_NOTHING = frozenset({"five_bar", "delta"})
"""Robots with twice as many cases with nothing hidden."""

FROZEN_SHARE = 5
"""The frozen set, which is the same for every version, has one in so many of the cases."""
