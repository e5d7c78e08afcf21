"""Identified terms with a free exponent or frequency, if that is better or makes others superfluous."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice

from bench.diagnosis.base_model import BaseModel, added_effects, added_names, at_its_solution
from bench.diagnosis.discovery.grammar import LOAD, name_of
from bench.diagnosis.discovery.screen import Screened, at_place
from bench.diagnosis.discovery.source import law_effect
from bench.diagnosis.discovery.term import Term, about_its_mean, at_other_harmonics, freed
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.evidence import Samples, effects_prior, residual_squares
from bench.effects import EffectInstance
from bench.effects.select import at_joint, parameter_slices
from bench.identification.decision import RULE
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solve_only import solved_quickly
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Refined:
    """A converged model, its terms of the grammar by their effect's name, and its weight: see `Samples.log_posterior`;
    held_out: sum of squares on held-out data.
    """

    model: Prepared
    terms: Mapping[str, Term]
    weight: float
    held_out: float = 0.0

    def size(self, base_model: BaseModel) -> int:
        """Number of its effects beyond those of the starting model."""
        return len(added_names(base_model, self.model))


@dataclass(frozen=True)
class Judge:
    """Weights of models: samples that count, and nats that a term of the grammar must bring beyond an effect."""

    samples: Samples
    price: float

    def refined(self, model: Prepared, terms: Mapping[str, Term]) -> Refined:
        """A converged model with its weight."""
        names = {instance.name for instance in model.effects}
        residual = residual_squares(
            model, effects_prior(model.effects) + self.price * len(names & terms.keys())
        )
        return Refined(model, terms, residual.weight(self.samples), float(residual.squares[1].sum()))


def instances_of(name: str, screened: Screened, places: Sequence[Place]) -> tuple[EffectInstance, ...]:
    """A term at every motor, with constants there."""
    return tuple(
        at_joint(law_effect(name, [at_place(screened, place)], place)[0], place.name) for place in places
    )


@dataclass(frozen=True)
class _Variant:
    """A candidate model converged with nearby columns, and a function that converges it with exact ones."""

    looked_at: Refined
    exactly: Callable[[], Prepared]


def refined(
    base_model: BaseModel, model: Prepared, terms: Mapping[str, Term], places: Sequence[Place], judge: Judge
) -> Refined:
    """The best of the identified model and those with one more free constant, or with a wave at another harmonic.

    They have no more effects; those without an unneeded effect come first.

    Each is judged on recordings that were not fitted, first with nearby columns, as is the identified model; good ones
    are then converged with exact columns. `LawBounds.models` of them are tried, those with all or none of the other
    effects first. Raises TimeUpError after the deadline.
    """
    best = judge.refined(model, terms)
    looked_at = judge.refined(base_model.again_nearby(model), terms)
    for _ in range(best.size(base_model)):
        fewer = (
            (new, variant.looked_at)
            for variant in _fewer(base_model, looked_at, judge)
            if (new := _converged_if_better(base_model, variant, looked_at, best, judge))
        )
        simpler = next(fewer, None)
        if simpler is None:
            break
        best, looked_at = simpler
    for variant in islice(_tried(base_model, looked_at, places, judge), TOLERANCES.laws.models):
        if new := _converged_if_better(base_model, variant, looked_at, best, judge):
            best, looked_at = new, variant.looked_at
    return best


def _converged_if_better(
    base_model: BaseModel, variant: _Variant, looked_at: Refined, best: Refined, judge: Judge
) -> Refined | None:
    """A candidate, converged with exact columns; None if the best is as good. looked_at: see `_promises`."""
    if variant.looked_at.size(base_model) > best.size(base_model) or not _promises(
        base_model, variant, looked_at, best, judge
    ):
        return None
    new = judge.refined(variant.exactly(), variant.looked_at.terms)
    return new if new.weight > best.weight and not _slower(new) else None


def _promises(
    base_model: BaseModel, variant: _Variant, looked_at: Refined, best: Refined, judge: Judge
) -> bool:
    """Whether a model may be better than the best: by its error with nearby columns, then with exact ones at the same
    values.

    looked_at: the best with nearby columns.
    """
    near, nats = variant.looked_at, TOLERANCES.laws.nearby * RULE.prior
    if near.weight < looked_at.weight - nats:
        return False
    if near.model.nearby is None:
        return True
    there = with_effects(base_model.start, near.model.effects, near.model.present)
    return judge.refined(there, near.terms).weight > best.weight - nats


def _fewer(base_model: BaseModel, refinement: Refined, judge: Judge) -> Iterator[_Variant]:
    """The model without one of its effects, if a term remains."""
    names = added_names(base_model, refinement.model)
    for name in sorted(names):
        terms = {key: term for key, term in refinement.terms.items() if key != name}
        fewer = _without(base_model, refinement.model, names - {name}, refinement, judge) if terms else None
        if fewer is not None:
            yield _Variant(judge.refined(fewer, terms), partial(base_model.exactly, fewer))


def _tried(
    base_model: BaseModel, refinement: Refined, places: Sequence[Place], judge: Judge
) -> Iterator[_Variant]:
    """Models with one free constant in a term, with all other effects, none of them, and all but one.

    refinement: their starting model, converged with nearby columns.
    """
    wholes = []

    def as_variant(look: Prepared, exactly: Callable[[], Prepared], name: str, variant: Term) -> _Variant:
        kept = added_names(base_model, look)
        terms = {key: term_of for key, term_of in refinement.terms.items() if key in kept} | {name: variant}
        return _Variant(judge.refined(look, terms), exactly)

    def with_others(others: Sequence[EffectInstance], name: str, variant: Term) -> _Variant:
        added = instances_of(name, Screened(variant, {}, 0.0), places)
        exactly = partial(base_model.with_instances, [*others, *added])
        if refinement.model.nearby is None or not others:
            exact = exactly()
            return as_variant(exact, lambda: exact, name, variant)
        return as_variant(base_model.joined_nearby(refinement.model, others, added), exactly, name, variant)

    present = added_names(base_model, refinement.model)
    for name, term in refinement.terms.items():
        for variant, mean in _with_a_mean(term, present):
            others = [
                instance
                for instance in added_effects(base_model, refinement.model)
                if instance.name not in (name, mean)
            ]
            yield with_others(others, f"{name}_mean", variant)
    for name, term in refinement.terms.items():
        others = [
            instance for instance in added_effects(base_model, refinement.model) if instance.name != name
        ]
        for variant in (*at_other_harmonics(term), *freed(term)):
            free = f"{name}_free"
            if others:
                yield with_others([], free, variant)
            whole = with_others(others, free, variant)
            yield whole
            wholes.append((whole.looked_at.model, free, variant, {instance.name for instance in others}))
    for whole_model, free, variant, names in wholes:
        for name in sorted(names) if len(names) > 1 else ():
            fewer = _without(base_model, whole_model, {*names, free} - {name}, refinement, judge)
            if fewer is not None:
                yield as_variant(fewer, partial(base_model.exactly, fewer), free, variant)


def _with_a_mean(term: Term, names: Collection[str]) -> Iterator[tuple[Term, str]]:
    """A wave of the load together with its mean, if this was identified by name, at this and other harmonics.

    Each is part of the load of the other, which only one law of both can represent.
    """
    for harmonic in (term, *at_other_harmonics(term)):
        joined = about_its_mean(harmonic)
        if joined is None or LOAD not in term.variables:
            continue
        variant, mean = joined
        name = name_of(mean)
        if name is not None and name in names:
            yield variant, name


def _slower(new: Refined) -> bool:
    """Whether a wave's rate is below its range, at the motor where the law is largest.

    Such a slow wave is a straight line over the travel and imitates something else.
    """
    values = solved_quickly(new.model)[1].theta[new.model.layout.effect_slice]
    largest: dict[str, tuple[float, EffectInstance]] = {}
    for instance, part in parameter_slices(new.model.effects):
        if instance.name not in new.terms:
            continue
        size = sum(float(((seen.effects[:, :, part] @ values[part]) ** 2).sum()) for seen in new.model.fitted)
        if size >= largest.get(instance.name, (0.0, instance))[0]:
            largest[instance.name] = size, instance
    return any(
        value < number.low
        for name, (_, effect_instance) in largest.items()
        for number, value in zip(
            new.terms[name].numbers, effect_instance.effect.shape_values().values(), strict=True
        )
        if number.name == "w"
    )


def _without(
    base_model: BaseModel, whole: Prepared, kept: Collection[str], refinement: Refined, judge: Judge
) -> Prepared | None:
    """A converged model without some of its effects; None if it explains far less with the others unchanged.

    Columns are those of the whole: nearby or exact.
    """
    remaining = [instance for instance in added_effects(base_model, whole) if instance.name in kept]
    fewer = with_effects(whole, (*whole.effects[: len(base_model.start.effects)], *remaining))
    if judge.refined(fewer, {}).held_out > TOLERANCES.laws.start_error * refinement.held_out:
        return None
    return at_its_solution(converged(fewer, nearly=True, deadline=base_model.deadline))
