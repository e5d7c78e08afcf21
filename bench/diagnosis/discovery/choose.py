"""The set of effects and terms that the data support, reached from many beginnings by changing one member at a time."""

from collections.abc import Iterable, Sequence

from bench.basics.deadline import NEVER, Deadline
from bench.diagnosis.batched_sets import enlarged, reduced, solve_sets, swapped
from bench.diagnosis.normal_equations import SetFit, System, solve_set
from bench.diagnosis.search import NEEDED, Scored, earned, possible, score, simplest

BEGUN = 4  # sets from which a search sets out
STEPS = 6
LARGEST = 6  # members of a set
SWAPS = (
    5  # sets with another effect in the place of one of an impossible sign that are looked at more closely
)


def best_set(
    system: System, begin: Iterable[Sequence[int]], usable: Sequence[int], deadline: Deadline = NEVER
) -> Scored:
    """The best set that is reached, of members that all earn their place.

    begin: start sets, in addition to the empty one. usable: candidates (indices) that may join or stand in for a
    member. Evidence, priors and what each member must earn are those of the diagnosis's search. Raises TimeUpError
    after the deadline.
    """
    empty = solve_set(system, ())
    starts = _scored(system, begin, empty)[:BEGUN]
    best = score(system, empty, empty)
    for start in [best, *starts]:
        here = _climbed(system, start, usable, empty, deadline)
        if here.total > best.total + NEEDED or (
            here.total > best.total and len(here.fit.chosen) <= len(best.fit.chosen)
        ):
            best = here
    return best


def _climbed(
    system: System, start: Scored, usable: Sequence[int], empty: SetFit, deadline: Deadline
) -> Scored:
    """One change after the other, as long as evidence grows; members that do not earn their place leave."""
    here = _all_earned(system, start, usable, empty)
    for _ in range(STEPS):
        deadline.check()
        chosen = here.fit.chosen
        others = [i for i in usable if i not in chosen]
        tried = swapped(chosen, others)
        if len(chosen) < LARGEST:
            tried += enlarged(chosen, others)
        better = [
            scored
            for scored in _scored(system, tried, empty)
            if scored.total > here.total + _needed(here, scored)
        ]
        able = [scored for scored in better if possible(system, scored.fit)][:20]
        found = next((scored for scored in able if earned(system, scored, empty)), None)
        if found is None:
            return here
        here = simplest(system, found, able)
    return here


def _needed(here: Scored, scored: Scored) -> float:
    return NEEDED if len(scored.fit.chosen) > len(here.fit.chosen) else 0.0


def _all_earned(system: System, scored: Scored, usable: Sequence[int], empty: SetFit) -> Scored:
    """Without the members that do not earn their place, the least first.

    Where a sign is impossible, another effect in the place of one member comes first, if all of that set earn theirs:
    what the sign belongs to may stand for a neighbour, as a spring that pushes stands for an offset.
    """
    while scored.fit.chosen and not (possible(system, scored.fit) and earned(system, scored, empty)):
        chosen = scored.fit.chosen
        if not possible(system, scored.fit):
            swaps = swapped(chosen, [i for i in usable if i not in chosen])
            able = [each for each in _scored(system, swaps, empty) if possible(system, each.fit)][:SWAPS]
            found = next((each for each in able if earned(system, each, empty)), None)
            if found is not None:
                return found
        scored = _scored(system, reduced(chosen), empty)[0]
    return scored


def _scored(system: System, sets: Iterable[Sequence[int]], empty: SetFit) -> list[Scored]:
    """The best first."""
    return sorted(
        (score(system, fit, empty) for fit in solve_sets(system, sets)), key=lambda scored: -scored.total
    )
