"""Residuals without a formula, as measured: at each motor a smooth function of variables."""

import re
from collections.abc import Collection, Sequence

import numpy as np

from bench.diagnosis.discovery.factors import Factor, Power, table_over
from bench.diagnosis.discovery.grammar import TOOL, A, Q, T, V
from bench.diagnosis.discovery.laws import Law
from bench.diagnosis.discovery.screen import Known, Residual, Screened, few_rows, residual_without
from bench.diagnosis.discovery.seen import has_tool, places_of, seen_at
from bench.diagnosis.discovery.source import law_effect
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Kind, Place, Seen, Variable
from bench.diagnosis.search_result import SearchResult
from bench.effects.select import at_joint
from bench.identification.decision import RULE
from bench.identification.partial_regression import partial_regression
from bench.identification.prepare import Prepared
from bench.identification.solve_only import solved_quickly
from bench.identification.tolerances import TOLERANCES

OF_OTHERS: tuple[Kind, ...] = ("position", "velocity")
VALIDITY = "What was measured, not a law: valid where the data were, and constant beyond."


def tabled_laws(finding: SearchResult, taken: Collection[str]) -> list[Law]:
    """A law without a formula for every motor at which such a function explains much of the residual.

    taken: names already in use.
    """
    model = finding.model
    stack, solution = solved_quickly(model)
    regression = partial_regression(stack, solution)
    places = places_of(model)
    rows = few_rows(len(regression.remainder))
    views = [seen_at(model, place) for place in places]
    tried = [_terms(model, place, seen) for place, seen in zip(places, views, strict=True)]
    known = [Known(seen, rows, terms) for seen, terms in zip(views, tried, strict=True)]
    residual = residual_without(regression, known, rows)
    laws = []
    for place, terms in zip(places, tried, strict=True):
        chosen = _chosen(residual, place.index, terms)
        if chosen:
            laws.append(_law(chosen, place, taken))
    return laws


def _terms(model: Prepared, place: Place, seen: Seen) -> list[Term]:
    """For each variable, a function, one that reverses with the direction of motion, and one times the speed."""
    of_motor = [Q, V, A, Variable("load"), T]
    others = [Variable(kind, ahead) for ahead in range(1, len(place.motors)) for kind in OF_OTHERS]
    tool = [TOOL] if has_tool(model) else []
    carriers: list[tuple[Factor, ...]] = [(), (Power(V, 0.0),), (Power(V),)]
    terms = []
    for variable in (*of_motor, *tool, *others):
        values = seen.values[variable]
        if not np.ptp(values) > 0.0:
            continue
        among = [0.0] if values.min() < 0.0 < values.max() and variable != Q else []
        table = table_over(variable, values, TOLERANCES.laws.knots, among)
        terms += [Term((*carrier, table)) for carrier in carriers if not (carrier and variable == V)]
    return terms


def _chosen(residual: Residual, motor: int, terms: Sequence[Term]) -> list[Term]:
    """One term after the other, while it is worth its unknowns."""
    chosen: list[Term] = []
    price = RULE.prior + float(np.log(len(terms)))
    for _ in range(TOLERANCES.laws.functions):
        usable = [term for term in terms if not _overlaps(term, chosen)]
        gains = [_worth(residual, motor, term, price) for term in usable]
        if not gains or max(gains) <= 0.0:
            break
        chosen.append(usable[int(np.argmax(gains))])
        residual = residual.orthogonal_to(Screened(chosen[-1], {}, 0.0), [motor])
    return chosen


def _worth(residual: Residual, motor: int, term: Term, price: float) -> float:
    """Nats that a term at a motor gains beyond the cost of its unknowns."""
    explained = residual.explained_at(term, motor)
    gained = -0.5 * residual.rows * np.log(max(1.0 - explained / residual.squares, 1e-12))
    return float(gained - 0.5 * np.log(residual.rows) * term.parts - price)


def _overlaps(term: Term, chosen: Sequence[Term]) -> bool:
    """Whether two functions have the same carrier, and so share a constant or a friction."""
    return any(taken.factors[:-1] == term.factors[:-1] for taken in chosen)


def _law(terms: Sequence[Term], place: Place, taken: Collection[str]) -> Law:
    plain = re.sub(r"\W", "_", f"measured_{place.name}").lower()
    name = plain
    while name in taken:
        name += "_"
    effect, source = law_effect(name, terms, place, VALIDITY)
    return Law(name, tuple(terms), (place,), (at_joint(effect, place.name),), source)
