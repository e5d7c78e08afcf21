"""Laws for what a diagnosis leaves unexplained: terms of a grammar compete with the catalogue."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.progress import SILENT, Progress
from bench.diagnosis.base_model import BaseModel
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.discovery.grammar import BASICS, grammar, name_of
from bench.diagnosis.discovery.refine import Judge, Refined, instances_of, refined
from bench.diagnosis.discovery.screen import Known, few_rows, residual_without
from bench.diagnosis.discovery.seen import places_of, scope_of, seen_at
from bench.diagnosis.discovery.states import State, best_states
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.error_floor import judged_by_its_error
from bench.diagnosis.round import Round, reshaped_proposals, usable
from bench.diagnosis.rounds import system_about
from bench.diagnosis.search import Selection, best_set, score_set
from bench.diagnosis.system import System
from bench.effects.select import parameter_slices
from bench.identification.decision import RULE
from bench.identification.partial_regression import partial_regression
from bench.identification.prepare import Prepared
from bench.identification.solve_only import solved_quickly
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Laws:
    """The last round of a search, and the terms of the grammar among its proposals by the name of their effect."""

    last: Round
    terms: Mapping[str, Term]

    @property
    def selected(self) -> dict[str, Term]:
        """The terms of the best set."""
        return {name: term for name, term in self.terms.items() if name in self.last.names}


def search_laws(
    base_model: BaseModel, last: Round, barred: Collection[str], progress: Progress = SILENT
) -> tuple[Laws, Refined] | None:
    """Terms that improve on the catalogue, with its effects or in place of them; None if there are none.

    Rounds end when the converged model is no better than the last one. last: of a search among the effects of the
    catalogue, with its converged model; barred: names that may not be selected. Raises TimeUpError after the deadline.
    """
    last = replace(last, model=base_model.exactly(last.model))
    laws, judge = Laws(last, {}), Judge(last.system.samples, 0.0)
    for number in range(TOLERANCES.laws.rounds):
        base_model.deadline.check()
        progress.phase(f"searching for laws, round {number + 1}")
        states, count = _states(base_model, laws)
        if not states:
            break
        if number:
            laws = replace(
                laws, last=replace(laws.last, proposals=reshaped_proposals(base_model, laws.last, SILENT))
            )
        new = _round(base_model, laws, barred, states, count)
        if new.last.names == laws.last.names:
            laws = new
            break
        judge = Judge(new.last.system.samples, RULE.prior + float(np.log(count)))
        model = base_model.with_proposals(new.last.proposals, new.last.chosen)
        converged = judge.refined(model, new.selected)
        if converged.weight <= judge.refined(laws.last.model, laws.selected).weight:
            break
        laws = replace(new, last=replace(new.last, model=model))
    if not laws.selected:
        return None
    return laws, refined(base_model, laws.last.model, laws.selected, places_of(base_model.start), judge)


def _round(
    base_model: BaseModel, laws: Laws, barred: Collection[str], states: Sequence[State], count: int
) -> Laws:
    """The best set of identified effects and new terms, about the identified model; count: of terms tried."""
    this_round = laws.last
    places = places_of(base_model.start)
    terms = dict(laws.selected)
    proposals = [
        proposal
        for proposal in this_round.proposals
        if proposal.name not in laws.terms or proposal.name in terms
    ]
    taken = {proposal.name for proposal in proposals}
    by_structure = {term.structure: name for name, term in terms.items()}
    fresh = [screened for state in states for screened in state.terms]
    prior = RULE.prior + float(np.log(count))
    numbers = iter(range(len(fresh) + len(taken)))
    for screened in fresh:
        if len(terms) >= TOLERANCES.laws.terms:
            break
        if screened.term.structure in by_structure or name_of(screened.term) is not None:
            continue
        name = next(name for i in numbers if (name := f"term_{i}") not in taken)
        terms[name], by_structure[screened.term.structure] = screened.term, name
        proposals.append(Proposal(name, instances_of(name, screened, places), False, "", prior))
    index = {proposal.name: i for i, proposal in enumerate(proposals)}
    able = usable(proposals, barred)
    begin = [[index[name] for name in this_round.names]]
    for state in states[: TOLERANCES.laws.starts]:
        names = {
            by_structure.get(candidate.term.structure) or name_of(candidate.term) or ""
            for candidate in state.terms
        }
        chosen = {index[name] for name in (*names, *state.effects) if name in index}
        begin.append(sorted(chosen.intersection(able)))

    def searched(system: System) -> Selection:
        best = best_set(system, begin, able, base_model.deadline)
        return Selection(best, {i: score_set(system, (i,)) for i in able})

    system, selection = judged_by_its_error(
        system_about(base_model, this_round.model, proposals), base_model.floor, searched
    )
    return Laws(Round(this_round.model, proposals, system, selection), terms)


def _states(base_model: BaseModel, laws: Laws) -> tuple[list[State], int]:
    """Sets of terms added to nothing, to the identified effects, and to these without each one; and their number."""
    model = laws.last.model
    names = laws.last.names
    stack, solution = solved_quickly(model)
    regression = partial_regression(stack, solution)
    seen = replace(model, signals=base_model.nearby.signals(model.present, model.signals))
    places = places_of(seen)
    terms = grammar(scope_of(seen, regression, places))
    rows = few_rows(len(regression.remainder))
    known = [Known(seen_at(seen, place), rows, terms) for place in places]
    columns, unknowns = _columns_of(model, len(base_model.start.effects))
    lefts = {}
    fewer = [names, *(names - {name} for name in sorted(names)), set[str]()]
    for kept in {tuple(sorted(some)): some for some in fewer}.values():
        base_model.deadline.check()
        out = [i for name, some in columns.items() if name not in kept for i in some]
        count = sum(unknowns[name] for name in kept)
        lefts[tuple(sorted(kept))] = (
            residual_without(regression, known, rows, out, solution.theta[out].tolist()),
            count,
        )
    return best_states(lefts, terms, BASICS, base_model.deadline), len(terms)


def _columns_of(model: Prepared, given_count: int) -> tuple[dict[str, list[int]], dict[str, int]]:
    """For every effect after the first `given_count`: its columns among the model's, and its number of unknowns."""
    columns: dict[str, list[int]] = {}
    unknowns: dict[str, int] = {}
    first = model.layout.effect_slice.start
    for instance, part in parameter_slices(model.effects)[given_count:]:
        at = range(first + part.start, first + part.stop)
        columns.setdefault(instance.name, []).extend(at)
        unknowns[instance.name] = unknowns.get(instance.name, 0) + len(at) + len(instance.effect.shape)
    return columns, unknowns
