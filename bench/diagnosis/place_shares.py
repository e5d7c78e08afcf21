"""How probable it is that an identified effect acts at each of its places, given that it is there."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit

from bench.diagnosis.normal_equations import Candidate, System, solve_set
from bench.effects import EffectInstance

Places = Mapping[str, Sequence[str]]
"""Names of effects -> places of each."""


def place_shares(
    system: System,
    chosen: Sequence[int],
    identified: Sequence[EffectInstance],
    alike: Mapping[str, Places],
) -> dict[str, dict[str, float]]:
    """For every effect of a set, by name: the probability (0 to 1) of each place, given that the effect is there.

    A place has one half if the set is as probable without it (`Samples.log_posterior`; an effect of one place has
    it). system: about the identified model. identified: its effects, each at the places of the answer. alike: by
    effect and place, other places that the data cannot tell from it; these share one probability.
    """
    kept: dict[str, set[str]] = {}
    for instance in identified:
        kept.setdefault(instance.effect.name, set()).add(instance.place)
    whole = _weight(system, chosen, kept)
    result: dict[str, dict[str, float]] = {}
    for i in chosen:
        instances = system.candidates[i].instances
        name = instances[0].effect.name
        of_answer = kept.get(name, set())
        known = result.setdefault(name, {})
        for instance in sorted(instances, key=lambda instance: instance.place not in of_answer):
            place, share = instance.place, 1.0
            if of_answer - {place}:
                other = _weight(system, chosen, {**kept, name: of_answer ^ {place}})
                share = float(expit(whole - other if place in of_answer else other - whole))
            places = (place, *alike.get(name, {}).get(instance.joint, ()))
            for each in places:
                known.setdefault(each, share / len(places))
    return result


def _weight(system: System, chosen: Sequence[int], places: Mapping[str, Collection[str]]) -> float:
    """Logarithm of a set's weight with its effects at these places, whatever its effects are."""
    candidates = list(system.candidates)
    for i in chosen:
        candidates[i] = _at(candidates[i], places.get(candidates[i].instances[0].effect.name, ()))
    fit = solve_set(replace(system, candidates=tuple(candidates), solved={}), chosen)
    return float(system.samples.log_posterior(fit.by_motor, len(fit.columns), 0.0))


def _at(candidate: Candidate, places: Collection[str]) -> Candidate:
    """An effect at some of its places; at all of them where none is given."""
    there = np.array([not places or instance.place in places for instance in candidate.instances])
    columns = np.repeat(there, [len(instance.effect.parameters) for instance in candidate.instances])
    instances = tuple(instance for instance, at in zip(candidate.instances, there, strict=True) if at)
    return Candidate(instances, candidate.columns[columns], candidate.lengths[columns])
