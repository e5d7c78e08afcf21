"""An effect at the places where it makes a set more probable, in place of all possible ones."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from math import comb, log

from bench.diagnosis.candidates import Proposal
from bench.diagnosis.places import AT_MOTORS, weight_at
from bench.diagnosis.system import System


@dataclass(frozen=True)
class AtPlaces:
    """The best places of an effect in a set, the nats that they bring over all places, and those of their choice."""

    places: frozenset[str]
    gained: float
    prior: float


def best_places(system: System, chosen: Sequence[int], i: int) -> AtPlaces:
    """Places of candidate i, a member of the set, by forward selection; all if no fewer are more probable.

    An effect in a passive joint or of a body has an unknown at each of many places, of which a machine may have one:
    the others only cost. k of n places cost the logarithm of the number of such choices. Motors have separate
    equations, and their places do not compete.
    """
    instances = system.candidates[i].instances
    effect, every = instances[0].effect, frozenset(instance.place for instance in instances)
    if effect.place in AT_MOTORS or len(every) < 2:
        return AtPlaces(every, 0.0, 0.0)

    def weight(places: Collection[str]) -> float:
        return weight_at(system, chosen, {effect.name: places}) - _prior(len(places), len(every))

    best, whole = frozenset[str](), weight(every)
    highest = -float("inf")
    while best < every:
        wider = max((best | {place} for place in sorted(every - best)), key=weight)
        if weight(wider) <= highest:
            break
        best, highest = wider, weight(wider)
    if highest <= whole:
        return AtPlaces(every, 0.0, 0.0)
    return AtPlaces(best, highest - whole, _prior(len(best), len(every)))


def most_gained(system: System, i: int) -> float:
    """Nats that fewer places of candidate i can bring at most: those that its unknowns at all but one cost."""
    candidate = system.candidates[i]
    effect = candidate.instances[0].effect
    if effect.place in AT_MOTORS:
        return 0.0
    return float(system.samples.cost_of_unknowns(len(candidate.columns) - len(effect.parameters)))


def at_its_places(proposal: Proposal, best: AtPlaces) -> Proposal:
    """The proposal at these places."""
    instances = tuple(instance for instance in proposal.instances if instance.place in best.places)
    return replace(proposal, instances=instances, prior=proposal.prior + best.prior)


def _prior(few: int, every: int) -> float:
    return log(comb(every, few))
