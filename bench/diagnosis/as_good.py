"""Models that explain the data as well as the one that was found, and what they do to its drive gains."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice, zip_longest

from bench.diagnosis.candidates import Proposal
from bench.diagnosis.normal_equations import solve_set
from bench.diagnosis.rounds import Origin, Round
from bench.diagnosis.search import MATERIAL, Scored, close, score
from bench.effects import EffectInstance
from bench.identification.findings import runaway
from bench.identification.identify import fit
from bench.identification.result import Identification
from bench.identification.widened import gains_widened

MOST = 4  # models that are fitted, the best supported first


def with_spread_over_models(
    origin: Origin, last: Round, added: Sequence[EffectInstance], after: Identification
) -> Identification:
    """The found model's answer, with deviations of its gains that hold those of models that are as good.

    Where something is left that no effect accounts for, one effect more, or another in the place of a found one, stands
    for what it may be, whatever its sign: each has the shape of a torque that is not modelled. added: the found effects
    where they show.
    """
    others = []
    for chosen in _as_good(last):
        instances = [one for i in chosen for one in _instances(last.proposals[i], i in last.chosen, added)]
        other = fit(origin.with_instances(instances))
        if runaway(other) is None and _no_worse(other, after):
            others.append(other)
    return gains_widened(after, others)


def _as_good(last: Round) -> Iterator[tuple[int, ...]]:
    """Sets one effect away from the found one that the data support as well, the best first.

    By turns with one more, which keeps what the found ones do to the gains, and with another in the place of one.
    """
    system, best = last.system, last.found.best
    usable = [i for i, one in enumerate(last.proposals) if not one.absorbed and i not in last.chosen]

    def scored(chosen: Sequence[int]) -> Scored:
        return score(system, solve_set(system, chosen), last.found.empty)

    more = [scored((*last.chosen, i)) for i in usable]
    instead = [scored((*(c for c in last.chosen if c != k), i)) for k in last.chosen for i in usable]
    wider = _best_first(one for one in more if one.total > best.total)
    others = _best_first(one for one in instead if close(best, one))
    by_turns = (one for pair in zip_longest(wider, others) for one in pair if one is not None)
    for one in islice(by_turns, MOST):
        yield one.fit.chosen


def _best_first(sets: Iterable[Scored]) -> list[Scored]:
    return sorted(sets, key=lambda one: -one.total)


def _instances(proposal: Proposal, found: bool, added: Sequence[EffectInstance]) -> Sequence[EffectInstance]:
    """An effect at the places where it was found, or everywhere."""
    return [one for one in added if one.effect.name == proposal.name] if found else proposal.instances


def _no_worse(other: Identification, after: Identification) -> bool:
    """Whether another answer's error on what was not fitted is as small."""
    errors = other.error.validate, after.error.validate
    return errors[0] is not None and errors[1] is not None and errors[0] < (1.0 + MATERIAL) * errors[1]
