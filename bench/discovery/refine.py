"""Found terms with an exponent or a frequency set free, where that does better or makes others superfluous."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from bench.diagnosis.rounds import Problem
from bench.diagnosis.search import MATERIAL
from bench.discovery.screen import Screened, at_place
from bench.discovery.source import law_effect
from bench.discovery.term import Term, freed
from bench.discovery.variables import Place
from bench.effects import EffectInstance
from bench.identification.prepare import Prepared
from bench.identification.result import relative_error
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import modelled_series

AS_GOOD = 0.5 * MATERIAL  # by which the error may grow where fewer effects do


@dataclass(frozen=True)
class Refined:
    """A settled model, its terms of the grammar by the name of their effect, and its error where nothing was fitted."""

    model: Prepared
    terms: Mapping[str, Term]
    error: float

    def size(self, own: int) -> int:
        """How many effects it has beyond the first `own` instances."""
        return len({one.effect.name for one in self.model.effects[own:]})


def instances_of(name: str, one: Screened, places: Sequence[Place]) -> tuple[EffectInstance, ...]:
    """A term at every motor, with its numbers there."""
    return tuple(
        EffectInstance(law_effect(name, [at_place(one, place)], place)[0], place.name, f"{name}:{place.name}")
        for place in places
    )


def refined(problem: Problem, model: Prepared, terms: Mapping[str, Term], places: Sequence[Place]) -> Refined:
    """The best of the found model and those with one number more to be adapted, with fewer other effects or as many.

    Each is settled by itself and judged on recordings that were not fitted.
    """
    own = len(problem.start.effects)
    best = Refined(model, terms, _error(problem, model))
    for name in list(terms):
        for variant in freed(terms[name]):
            others = [one for one in model.effects[own:] if one.effect.name != name]
            free = f"{name}_free"
            added = instances_of(free, Screened(variant, {}, 0.0), places)
            for kept in _fewer(others):
                instances = [one for one in others if one.effect.name in kept]
                tried = problem.with_instances([*instances, *added])
                known = {key: one for key, one in terms.items() if key in kept} | {free: variant}
                new = Refined(tried, known, _error(problem, tried))
                if _better(new, best, own):
                    best = new
    return best


def _fewer(others: Sequence[EffectInstance]) -> list[Collection[str]]:
    """Which of the other effects stay: none, all but one of them, or all."""
    names = {one.effect.name for one in others}
    sets = [set[str](), *(names - {name} for name in sorted(names)), names]
    return list({frozenset(one): one for one in sets}.values())


def _better(new: Refined, old: Refined, own: int) -> bool:
    if new.size(own) < old.size(own):
        return new.error < (1.0 + AS_GOOD) * old.error
    return new.size(own) == old.size(own) and new.error < (1.0 - MATERIAL) * old.error


def _error(problem: Problem, model: Prepared) -> float:
    """Relative error of a settled model on recordings that were not fitted, without anything else of its answer."""
    _, solution = solved_quickly(model, problem.fit_gains)
    judged = [modelled_series(model, one, solution) for one in model.observations if one.use == "validate"]
    return relative_error(judged) or 0.0
