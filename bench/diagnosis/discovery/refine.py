"""Found terms with an exponent or a frequency set free, where that does better or makes others superfluous."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

from bench.diagnosis.discovery.grammar import LOAD
from bench.diagnosis.discovery.named import name_of
from bench.diagnosis.discovery.screen import Screened, at_place
from bench.diagnosis.discovery.source import law_effect
from bench.diagnosis.discovery.term import Term, about_its_mean, at_other_harmonics, freed
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.rounds import Origin, at_its_solution, error_of
from bench.diagnosis.search import MATERIAL
from bench.effects import EffectInstance
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solve_only import solved_quickly

MOST = 18  # models that are tried
AS_GOOD = 0.5 * MATERIAL  # by which the error may grow where fewer effects do
FAR_LESS = 1.5  # times the best error: a model that starts from there is not converged


@dataclass(frozen=True)
class Refined:
    """A converged model, its terms of the grammar by their effect's name, and its error where nothing was fitted."""

    model: Prepared
    terms: Mapping[str, Term]
    error: float

    def size(self, own: int) -> int:
        """How many effects it has beyond the first `own` instances."""
        return len({instance.effect.name for instance in self.model.effects[own:]})


def instances_of(name: str, screened: Screened, places: Sequence[Place]) -> tuple[EffectInstance, ...]:
    """A term at every motor, with its numbers there."""
    return tuple(
        EffectInstance(
            law_effect(name, [at_place(screened, place)], place)[0], place.name, f"{name}:{place.name}"
        )
        for place in places
    )


def refined(origin: Origin, model: Prepared, terms: Mapping[str, Term], places: Sequence[Place]) -> Refined:
    """The best of the found model and those with one number more to be adapted, or with a wave at another harmonic.

    They have fewer other effects or as many.

    Each is converged by itself and judged on recordings that were not fitted; MOST of them, those beside all or none of
    the other effects first.
    """
    own = len(origin.start.effects)
    best = Refined(model, terms, error_of(model))
    for new in islice(_tried(origin, best, places), MOST):
        if new.size(own) <= best.size(own) and better(new, best, own) and not _slower(new, own):
            best = new
    return best


def _tried(origin: Origin, found: Refined, places: Sequence[Place]) -> Iterator[Refined]:
    """Converged models with a number of one term set free, with all other effects, none of them, and all but one."""
    own = len(origin.start.effects)
    wholes = []

    def told(model: Prepared, name: str, variant: Term) -> Refined:
        kept = {instance.effect.name for instance in model.effects[own:]}
        terms = {key: found_term for key, found_term in found.terms.items() if key in kept} | {name: variant}
        return Refined(model, terms, error_of(model))

    added_names = {instance.effect.name for instance in found.model.effects[own:]}
    for name, term in found.terms.items():
        for variant, mean in _with_a_mean(term, added_names):
            others = [
                instance for instance in found.model.effects[own:] if instance.effect.name not in (name, mean)
            ]
            added = instances_of(f"{name}_mean", Screened(variant, {}, 0.0), places)
            yield told(origin.with_instances([*others, *added]), f"{name}_mean", variant)
    for name, term in found.terms.items():
        others = [instance for instance in found.model.effects[own:] if instance.effect.name != name]
        for variant in (*at_other_harmonics(term), *freed(term)):
            free = f"{name}_free"
            added = instances_of(free, Screened(variant, {}, 0.0), places)
            if others:
                yield told(origin.with_instances(added), free, variant)
            whole = origin.with_instances([*others, *added])
            yield told(whole, free, variant)
            wholes.append((whole, free, variant, {instance.effect.name for instance in others}))
    for whole, free, variant, names in wholes:
        for name in sorted(names) if len(names) > 1 else ():
            fewer = _without(origin, whole, {*names, free} - {name}, found.error)
            if fewer is not None:
                yield told(fewer, free, variant)


def _with_a_mean(term: Term, names: Collection[str]) -> Iterator[tuple[Term, str]]:
    """A wave of the load together with its mean, where that is found by its name, at this and other harmonics.

    Each is a part of the load of the other, which only one law of both can tell.
    """
    for harmonic in (term, *at_other_harmonics(term)):
        joined = about_its_mean(harmonic)
        if joined is None or LOAD not in term.variables:
            continue
        variant, mean = joined
        name = name_of(mean)
        if name is not None and name in names:
            yield variant, name


def _slower(new: Refined, own: int) -> bool:
    """Whether a wave's rate has run below the range that it is free in, at the motor where that law is largest.

    So slow a wave is a straight line over the travel, and stands for something else.
    """
    at = new.model.layout.size - new.model.layout.effects
    _, solution = solved_quickly(new.model)
    largest: dict[str, tuple[float, EffectInstance]] = {}
    begin = 0
    for i, instance in enumerate(new.model.effects):
        part = slice(begin, begin := begin + len(instance.effect.parameters))
        if i < own or instance.effect.name not in new.terms:
            continue
        values = solution.theta[at + part.start : at + part.stop]
        size = sum(float(((seen.effects[:, :, part] @ values) ** 2).sum()) for seen in new.model.fitted)
        if size >= largest.get(instance.effect.name, (0.0, instance))[0]:
            largest[instance.effect.name] = size, instance
    return any(
        value < number.low
        for name, (_, effect_instance) in largest.items()
        for number, value in zip(
            new.terms[name].numbers, effect_instance.effect.shape_values().values(), strict=True
        )
        if number.name == "w"
    )


def _without(origin: Origin, whole: Prepared, kept: Collection[str], error: float) -> Prepared | None:
    """A converged model without some of its effects; None where that explains far less, the others as they are."""
    own = len(origin.start.effects)
    left = [instance for i, instance in enumerate(whole.effects) if i < own or instance.effect.name in kept]
    fewer = with_effects(whole, left)
    if error_of(fewer) > FAR_LESS * error:
        return None
    return at_its_solution(converged(fewer, nearly=True))


def better(new: Refined, old: Refined, own: int) -> bool:
    """Whether a model's error is clearly smaller, or as small with fewer effects beyond the first `own` instances."""
    fewer = new.size(own) < old.size(own)
    return new.error < ((1.0 + AS_GOOD) if fewer else (1.0 - MATERIAL)) * old.error
