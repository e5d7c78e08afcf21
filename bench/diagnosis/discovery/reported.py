"""Laws in an answer: their records, and their effect on the catalogue's verdicts."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from math import hypot

from bench.diagnosis.batched_sets import solve_set
from bench.diagnosis.discovery.grammar import name_of
from bench.diagnosis.discovery.laws import Law
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.reason import Because, Doubt, Reason
from bench.diagnosis.result import (
    Diagnosis,
    Discovered,
    EffectVerdict,
    LadderStep,
    LawTerm,
    LooksAt,
    Unexplained,
)
from bench.diagnosis.round import Round
from bench.diagnosis.search import held_out_error, possible, score_set
from bench.diagnosis.search_result import SearchResult
from bench.identification.decision import RULE
from bench.identification.result import ErrorSummary


def with_discovered(
    finding: SearchResult, laws: Sequence[Law], tried: Sequence[Law], diagnosis: Diagnosis
) -> Diagnosis:
    """The diagnosis with laws as discovered and catalogue effects as missing. tried: laws that competed."""
    names = {law.name: () for law in tried} | {
        law.name: tuple(place.name for place in law.places if _stays_at(finding, law, place)) for law in laws
    }
    ranking = tuple(_without(verdict, names) for verdict in diagnosis.ranking if verdict.effect not in names)
    ranking = doubted(finding, laws, ranking, diagnosis.unexplained)
    return replace(
        diagnosis,
        missing=tuple(name for name in diagnosis.missing if name not in names),
        ranking=ranking,
        discovered=tuple(
            discovered_at(finding, law, i)
            for law in laws
            for i, place in enumerate(law.places)
            if _stays_at(finding, law, place)
        ),
    )


def _stays_at(finding: SearchResult, law: Law, place: Place) -> bool:
    """Whether a law stays at a place: it leaves places where it is zero."""
    return place.name in finding.after.effect_parameters[law.name]


def _without(verdict: EffectVerdict, laws: Mapping[str, Sequence[str]]) -> EffectVerdict:
    """A verdict that names only effects of the catalogue. laws: by name, the motors at which they stay.

    An effect is indistinguishable only from others of the catalogue. An effect that is as good as laws only resembles
    these; an identified one whose only alternative is a law is as certain as without it.
    """
    others = tuple(name for name in verdict.alternatives if name not in laws)
    if others or not verdict.alternatives:
        return replace(verdict, alternatives=others)
    if verdict.why.because is Because.AS_GOOD:
        places = dict.fromkeys(place for name in verdict.alternatives for place in laws[name])
        why = Reason(Because.AS_GOOD_AS_A_LAW, tuple(places), verdict.why.doubts)
        return replace(verdict, alternatives=(), verdict="resembles", why=why)
    return replace(verdict, alternatives=(), verdict="resembles" if verdict.why.doubts else "missing")


def discovered_at(finding: SearchResult, law: Law, i: int) -> Discovered:
    """A law at the i-th of its places, with its values, its errors, and the nearest effect."""
    place = law.places[i]
    values = finding.after.effect_parameters[law.name][place.name]
    linear = [parameter.name for parameter in law.instances[0].effect.parameters]
    numbers = {label: value for label, value in values.items() if label not in linear}
    terms = law.at({label: value.value for label, value in numbers.items()})
    formulas = [
        (formula, _looks_at(term.part(k), place))
        for term in terms
        for k, formula in enumerate(term.formulas(place))
    ]
    error = finding.after.error
    without = finding.fits(frozenset(finding.names) - {law.name}).step
    single = {name_of(term) for term in law.terms}
    return Discovered(
        place=place.name,
        law=law.name,
        terms=tuple(
            LawTerm(formula, values[label].value, values[label].std, values[label].unit, looks_at)
            for label, (formula, looks_at) in zip(linear, formulas, strict=True)
        ),
        numbers=numbers,
        identify=error.identify,
        validate=error.validate,
        without=without.reported,
        named=single.pop() if len(single) == 1 else None,
        nearest=_nearest(finding, law.name, without.validate),
        source=law.source,
    )


def _looks_at(term: Term, place: Place) -> tuple[LooksAt, ...]:
    return tuple(
        LooksAt(variable.kind, variable.motor(place) if variable.ahead else "", factor.role)
        for factor in term.factors
        for variable in factor.variables
    )


def _nearest(finding: SearchResult, law: str, without: float | None) -> tuple[str, float] | None:
    """The effect of the catalogue that best replaces a law, and its error."""
    system, proposals = finding.last.system, finding.last.proposals
    chosen = finding.last.selection.selected.fit.chosen
    others = tuple(i for i in chosen if proposals[i].name != law)
    selected_error = held_out_error(system, finding.last.selection.selected.fit)
    error = finding.after.error.validate
    if not selected_error or error is None or without is None:
        return None
    scale = error / selected_error
    tried = [
        (held_out_error(system, solve_set(system, (*others, i))) * scale, proposals[i].name)
        for i in finding.last.selection.singles
        if i not in chosen
    ]
    best = min(tried, default=None)
    return None if best is None or best[0] > (1.0 - RULE.helps) * without else (best[1], best[0])


def doubted(
    finding: SearchResult, laws: Sequence[Law], ranking: Sequence[EffectVerdict], remaining: Unexplained
) -> tuple[EffectVerdict, ...]:
    """The ranking in which small effects at the motors of laws only resemble something; if clearly more than noise
    remains, all effects there do, since the law is then wrong.

    A law from a finite grammar approximates the truth: if a second effect at its motor removes less than RULE.law_share
    of what the law removes, its name is uncertain. Both are errors on recordings that were not fitted, of models
    without the one and without the other.
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
    """Whether an effect explains little relative to the laws."""
    all_names = frozenset(finding.names)
    without_effect, by_laws = (
        _taken_away(finding, finding.fits(all_names.difference(out)).step) for out in ([effect], laws)
    )
    return without_effect < RULE.law_share**2 * by_laws


def _taken_away(finding: SearchResult, without: LadderStep) -> float:
    """Excess of a model's squared error over that of the identified one."""
    return _error(without) ** 2 - _error(finding.after.error) ** 2


def _error(summary: LadderStep | ErrorSummary) -> float:
    return float(summary.validate or summary.identify or 0.0)


def stood_for(this_round: Round, laws: Sequence[str], barred: Collection[str]) -> dict[str, int]:
    """Laws of the best set, by name, and a proposal (index) that does as well or better.

    For example, sign(load) is a constant offset if the load keeps its sign. Effects need less evidence than laws, so if
    both explain the same, the set with the effect is at least as probable.
    """
    system, proposals, selection = this_round.system, this_round.proposals, this_round.selection
    chosen, total = selection.selected.fit.chosen, selection.selected.total
    called: dict[str, int] = {}
    for name in laws:
        place = next((i for i in chosen if proposals[i].name == name), None)
        if place is None:
            continue
        others = tuple(i for i in chosen if i != place)
        tried = [
            (score_set(system, (*others, i)), i)
            for i in selection.singles
            if i not in chosen and proposals[i].name not in (*laws, *barred)
        ]
        able = [
            (scored.total, i) for scored, i in tried if scored.total >= total and possible(system, scored.fit)
        ]
        if able:
            best, i = max(able)
            chosen, total, called[name] = (*others, i), best, i
    return called
