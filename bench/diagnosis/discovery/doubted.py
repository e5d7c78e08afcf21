"""Effects of the catalogue that may only make up for what is inexact in a law at the same motor."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from math import hypot

from bench.diagnosis.discovery.laws import Law
from bench.diagnosis.reason import Doubt, Reason
from bench.diagnosis.result import EffectVerdict, LadderStep, Unexplained
from bench.diagnosis.search_result import SearchResult
from bench.identification.decision import RULE
from bench.identification.result import ErrorSummary


def doubted(
    finding: SearchResult, laws: Sequence[Law], ranking: Sequence[EffectVerdict], remaining: Unexplained
) -> tuple[EffectVerdict, ...]:
    """The ranking with small effects at the motors of laws as what resembles something: they are not sure; nor are
    others there where clearly more remains than noise: the law is not what is there, then.

    A law out of a finite grammar is near to what is there, seldom the same: what a second effect at its motor takes
    away, if that is less than RULE.law_share of what the law does, says little of the name. Both are errors on
    recordings that were not fitted, of models without the one and the other.
    """
    inexact = remaining.error > RULE.law_beyond_noise * hypot(remaining.noise_floor, remaining.encoders)
    places = {place.name for law in laws for place in law.places}
    names = {law.name for law in laws}
    return tuple(
        replace(verdict, verdict="resembles", why=_doubted(verdict.why))
        if verdict.verdict == "missing"
        and places.issuperset(verdict.actuators)
        and (inexact or _small(finding, verdict.effect, names))
        else verdict
        for verdict in ranking
    )


def _doubted(why: Reason) -> Reason:
    return replace(why, doubts=(*why.doubts, Doubt.BESIDE_A_LAW))


def _small(finding: SearchResult, effect: str, laws: Collection[str]) -> bool:
    """Whether an effect explains little compared with the laws."""
    all_names = frozenset(finding.names)
    without_effect, by_laws = (
        _taken_away(finding, finding.fits(all_names.difference(out)).step) for out in ([effect], laws)
    )
    return without_effect < RULE.law_share**2 * by_laws


def _taken_away(finding: SearchResult, without: LadderStep) -> float:
    """How much the squared error of a model exceeds that of the identified one."""
    return _error(without) ** 2 - _error(finding.after.error) ** 2


def _error(summary: LadderStep | ErrorSummary) -> float:
    return float(summary.validate or summary.identify or 0.0)
