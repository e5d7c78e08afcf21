"""The record of a discovered law at one motor."""

from bench.diagnosis.discovery.laws import Law
from bench.diagnosis.discovery.named import name_of
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.normal_equations import solve_set
from bench.diagnosis.result import Discovered, LawTerm, LooksAt
from bench.diagnosis.search import held_out_error
from bench.diagnosis.search_result import SearchResult
from bench.identification.decision import RULE


def discovered_at(finding: SearchResult, law: Law, i: int) -> Discovered:
    """A law at the i-th of its places, with its values, its errors, and what comes nearest to it."""
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
        without=without.identify if without.validate is None else without.validate,
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
    """The effect of the catalogue that does best in the place of a law, and the error with it."""
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
