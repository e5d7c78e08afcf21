"""Where an identified effect acts: the probability of each place, and other places that are as good."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from bench.diagnosis.batched_sets import solve_set
from bench.diagnosis.evidence import Samples, residual_squares
from bench.diagnosis.significance import wrong_signs
from bench.diagnosis.system import Candidate, System
from bench.effects import EffectInstance, places_in
from bench.effects.select import at_joint
from bench.identification.decision import RULE
from bench.identification.identify import fit
from bench.identification.prepare import Prepared, with_effects
from bench.identification.result import Identification

Places = Mapping[str, Sequence[str]]
"""Names of effects -> places of each."""


def place_shares(
    system: System, chosen: Sequence[int], identified: Sequence[EffectInstance], alike: Mapping[str, Places]
) -> dict[str, dict[str, float]]:
    """For every effect of a set, by name: the probability (0 to 1) of each place, given that the effect is there.

    A place has one half if the set is equally probable without it (`Samples.log_posterior`); a single place has one.
    system: about the identified model. identified: its effects, each at the places of the answer. alike: by effect and
    place, other places that the data cannot distinguish; these share one probability.
    """
    kept: dict[str, set[str]] = {}
    for instance in identified:
        kept.setdefault(instance.name, set()).add(instance.place)
    whole = weight_at(system, chosen, kept)
    result: dict[str, dict[str, float]] = {}
    for i in chosen:
        instances = system.candidates[i].instances
        name = instances[0].effect.name
        of_answer = kept.get(name, set())
        known = result.setdefault(name, {})
        for instance in sorted(instances, key=lambda instance: instance.place not in of_answer):
            place, share = instance.place, 1.0
            if of_answer - {place}:
                other = weight_at(system, chosen, {**kept, name: of_answer ^ {place}})
                share = float(expit(whole - other if place in of_answer else other - whole))
            places = (place, *alike.get(name, {}).get(instance.joint, ()))
            for each in places:
                known.setdefault(each, share / len(places))
    return result


def weight_at(system: System, chosen: Sequence[int], places: Mapping[str, Collection[str]]) -> float:
    """Log weight of a set with its effects, by name, at these places, at all if not given; without their priors."""
    candidates = list(system.candidates)
    for i in chosen:
        candidates[i] = _at(candidates[i], places.get(candidates[i].instances[0].effect.name, ()))
    fit = solve_set(replace(system, candidates=tuple(candidates), solved={}), chosen)
    return float(system.samples.log_posterior(fit.by_motor, len(fit.columns), 0.0))


def _at(candidate: Candidate, places: Collection[str]) -> Candidate:
    """An effect at some of its places; at all if none is given."""
    there = np.array([not places or instance.place in places for instance in candidate.instances])
    columns = np.repeat(there, [len(instance.effect.parameters) for instance in candidate.instances])
    instances = tuple(instance for instance, at in zip(candidate.instances, there, strict=True) if at)
    return Candidate(instances, candidate.columns[columns], candidate.lengths[columns])


AT_MOTORS = ("actuator", "robot")  # each has separate equations, or there is only one place


@dataclass(frozen=True)
class AlikePlaces:
    """For every effect, by name, and each of its places: others at which the model is hardly less probable; answers: of
    the models with the effect there.
    """

    places: Mapping[str, Mapping[str, tuple[str, ...]]]
    answers: tuple[Identification, ...]


def alike_places(model: Prepared, identified: Sequence[EffectInstance], samples: Samples) -> AlikePlaces:
    """Other places of a model's effects that the data do not distinguish from theirs.

    identified: effects of the model. Those at motors are omitted: each motor has a separate current.
    """
    places = places_in(model.model.geometry, model.dataset.weighed)
    there = {instance.seat for instance in model.effects}
    least = residual_squares(model, 0.0).weight(samples) - RULE.undecided
    by_effect: dict[str, dict[str, tuple[str, ...]]] = {}
    answers: list[Identification] = []
    for instance in identified:
        effect = instance.effect
        if effect.place in AT_MOTORS or instance.recording:
            continue
        moved = {
            joint: _as_probable(model, instance, joint, samples, least)
            for joint in places.where(effect)
            if (effect.name, joint) not in there
        }
        alike = {joint: answer for joint, answer in moved.items() if answer is not None}
        if alike:
            by_effect.setdefault(effect.name, {})[instance.joint] = tuple(alike)
            answers += alike.values()
    return AlikePlaces(by_effect, tuple(answers))


def _as_probable(
    model: Prepared, instance: EffectInstance, joint: str, samples: Samples, least: float
) -> Identification | None:
    """The answer of the model with an effect moved to another place; None if it has not this weight, or an impossible
    sign there.
    """
    moved = at_joint(instance.effect, joint)
    effects = [moved if each == instance else each for each in model.effects]
    there = with_effects(model, effects)
    if residual_squares(there, 0.0).weight(samples) <= least:
        return None
    answer = fit(there)
    return None if wrong_signs(answer, moved) else answer
