"""One power of the velocity in place of several frictions of the catalogue that only together come near it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from bench.diagnosis.catalogue_search import SearchResult
from bench.diagnosis.discovery.factors import Power
from bench.diagnosis.discovery.grammar import V
from bench.diagnosis.discovery.refine import AS_GOOD, Refined, instances_of
from bench.diagnosis.discovery.screen import Screened
from bench.diagnosis.discovery.seen import places_of
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.rounds import error_of
from bench.effects import Effect, EffectInstance

EXPONENTS = (0.5, 1.5, 2.5)
NAME = "power"


def merged(finding: SearchResult, catalogue: Mapping[str, Effect]) -> Refined | None:
    """The found model with a power of the velocity for some of its frictions, if that has fewer unknowns and leaves as
    little; None where there is nothing to be saved, or it leaves more.

    catalogue: in which the special cases of what was found are.
    """
    origin = finding.origin
    added = finding.model.effects[len(origin.start.effects) :]
    sits = [instance for instance in added if instance.effect.of_velocity]
    motors = [instance.joint for instance in sits]
    alike = [instance for instance in sits if motors.count(instance.joint) > 1]
    if not alike:
        return None
    others = [instance for instance in added if instance not in alike]
    places = [place for place in places_of(origin.start) if place.name in {each.joint for each in alike}]
    enough = (1.0 + AS_GOOD) * error_of(finding.model)
    for kept in fewer(alike, 2 * len(places), catalogue):
        found = []
        for exponent in EXPONENTS:
            term = Term((Power(V, exponent, free=True),))
            instances = instances_of(NAME, Screened(term, {}, 0.0), places)
            model = origin.with_instances([*others, *kept, *instances])
            found.append(Refined(model, {NAME: term}, error_of(model)))
        best = min(found, key=lambda refined: refined.error)
        if best.error < enough:
            return best
    return None


def fewer(
    alike: Sequence[EffectInstance], own: int, catalogue: Mapping[str, Effect]
) -> Iterator[list[EffectInstance]]:
    """The frictions that may stay beside a law with `own` unknowns, the fewest first, so that unknowns are saved: some
    of those that were found, or a special case of one.
    """
    names = sorted({instance.effect.name for instance in alike})
    for size in range(len(names)):
        sets = [
            [instance for instance in alike if instance.effect.name in stay]
            for stay in combinations(names, size)
        ]
        if size == 1:
            sets = [*_special_cases(alike, catalogue), *sets]
        yield from (kept for kept in sets if _unknowns(kept) + own < _unknowns(alike))


def _special_cases(
    alike: Sequence[EffectInstance], catalogue: Mapping[str, Effect]
) -> Iterator[list[EffectInstance]]:
    """In place of one found effect each of its special cases that was not found."""
    found = {instance.effect.name for instance in alike}
    for special in sorted({name for instance in alike for name in instance.effect.contains} - found):
        yield [
            replace(instance, effect=catalogue[special], request=f"{special}:{instance.joint}")
            for instance in alike
            if special in instance.effect.contains
        ]


def _unknowns(instances: Sequence[EffectInstance]) -> int:
    return sum(len(instance.effect.parameters) + len(instance.effect.shape) for instance in instances)
