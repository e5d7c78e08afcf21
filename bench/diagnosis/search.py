"""Search the small set of effects that the data support best."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.diagnosis.batched_sets import enlarged, reduced, solve_set, solve_sets, swapped
from bench.diagnosis.evidence import Samples
from bench.diagnosis.system import Candidate, SetFit, System, squared_errors
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Scored:
    """A set with the logarithm of its weight, `total`, and of its likelihood on judged recordings, nats."""

    fit: SetFit
    held_out: float
    total: float


def score(system: System, fit: SetFit) -> Scored:
    """See `Samples.log_posterior`. Judged recordings have no fitted parameter, so their likelihood, of all samples,
    needs no penalty.
    """
    logs = np.log(fit.by_motor[1] + np.finfo(float).tiny)
    held_out = -0.5 * float(system.held_out.rows_of_motor @ logs) / system.autocorrelation_time
    return Scored(fit, held_out, log_posterior(system, fit, system.samples))


def score_set(system: System, chosen: Sequence[int]) -> Scored:
    """A set, solved."""
    return score(system, solve_set(system, chosen))


def log_posterior(system: System, fit: SetFit, samples: Samples) -> float:
    """Log weight of a set, with these samples: see `Samples.log_posterior`."""
    return float(samples.log_posterior(fit.by_motor, len(fit.columns), system.prior_of(fit.chosen)))


@dataclass(frozen=True)
class Selection:
    """The most probable set, and every single effect alone."""

    selected: Scored
    singles: dict[int, Scored]


def search(system: System, usable: Sequence[int], deadline: Deadline = NEVER) -> Selection:
    """The most probable set of usable candidates (indices) without an impossible sign.

    All pairs and triples of the shortlist compete, so that a first choice does not stay if a better pair makes it
    superfluous; larger sets are reached by single changes. Raises TimeUpError after the deadline.
    """
    singles = dict(zip(usable, scored(system, [(i,) for i in usable]), strict=True))
    best = score_set(system, ())
    for size in range(1, TOLERANCES.search.exhaustive + 1):
        deadline.check()
        best = _best(system, best, combinations(_shortlist(system, usable, singles, best), size))
    return Selection(climbed(system, best, usable, deadline), singles)


def best_set(
    system: System, begin: Iterable[Sequence[int]], usable: Sequence[int], deadline: Deadline = NEVER
) -> Scored:
    """The most probable set that single changes reach from the empty set and from others.

    begin: start sets. usable: candidates (indices) that may join or replace a member. Raises TimeUpError after the
    deadline.
    """
    starts = [
        score_set(system, ()),
        *sorted(scored(system, [*begin]), key=_total)[-TOLERANCES.search.starts :],
    ]
    return max((climbed(system, start, usable, deadline) for start in starts), key=_total)


def climbed(system: System, start: Scored, usable: Sequence[int], deadline: Deadline = NEVER) -> Scored:
    """Hill climbing: add, exchange or omit one effect at a time, always the best change, while the set becomes more
    probable.

    From an impossible sign, any possible neighbour is better: its effect may imitate that one, as a pushing spring does
    an offset.
    """
    present = start
    for _ in range(TOLERANCES.search.changes):
        deadline.check()
        chosen, able = present.fit.chosen, possible(system, present.fit)
        near = neighbours(system, present, usable, -np.inf if not able else present.total)
        best = simplest(system, near[0], [*near, present] if able else near) if near else present
        if best is not present:
            present = best
        elif able:
            break
        else:
            present = max(scored(system, reduced(chosen)), key=_total)
    return present


def neighbours(system: System, present: Scored, usable: Sequence[int], least: float) -> list[Scored]:
    """Sets with one effect more, less or another, whose weight is above the least, the best first."""
    chosen = present.fit.chosen
    others = [i for i in usable if i not in chosen]
    sets = swapped(chosen, others) + (reduced(chosen) if chosen else [])
    if len(chosen) < TOLERANCES.search.largest:
        sets += enlarged(chosen, others)
    better = [each for each in scored(system, sets) if each.total > least and possible(system, each.fit)]
    return sorted(better, key=_total, reverse=True)


def _best(system: System, best: Scored, sets: Iterable[Sequence[int]]) -> Scored:
    """The most probable possible set, or a special case that is as good; `best` if none is better."""
    better = [each for each in scored(system, [*sets]) if each.total > best.total]
    able = [each for each in better if possible(system, each.fit)]
    return simplest(system, max(able, key=_total), able) if able else best


def scored(system: System, sets: Sequence[Sequence[int]]) -> list[Scored]:
    """Each of the sets, in their order."""
    return [score(system, fit) for fit in solve_sets(system, sets)]


def _total(each: Scored) -> float:
    return each.total


def _shortlist(system: System, usable: Sequence[int], singles: dict[int, Scored], best: Scored) -> list[int]:
    """Effects that explain most alone, or most with the best set so far: one may hide another."""
    chosen = best.fit.chosen
    alone = sorted(usable, key=lambda i: -singles[i].total)[: TOLERANCES.search.alone]
    others = [i for i in usable if i not in chosen]
    wider = scored(system, enlarged(chosen, others)) if chosen else []
    totals = {i: each.total for i, each in zip(others, wider, strict=False)}
    with_best = sorted(totals, key=lambda i: -totals[i])[: TOLERANCES.search.with_best]
    return list(dict.fromkeys([*chosen, *alone, *with_best]))


def held_out_error(system: System, fit: SetFit) -> float:
    """Relative error of a set on the recordings that were not fitted: RMS(error) / RMS(measured), all motors."""
    measured = system.held_out.measured
    error = squared_errors(system.held_out, fit, system.start)
    return float(np.sqrt(error.sum() / measured)) if measured else 0.0


def close(scored: Scored, other: Scored) -> bool:
    """Whether data cannot distinguish two sets: the second is hardly worse than the first."""
    return scored.total - other.total < RULE.undecided


def simplest(system: System, scored: Scored, rivals: Sequence[Scored]) -> Scored:
    """The set with fewest unknowns among equally good ones with a special case in place of an effect."""
    size = _unknowns(system, scored)
    simpler = [
        rival
        for rival in rivals
        if _unknowns(system, rival) < size
        and _special_case(system, rival.fit.chosen, scored.fit.chosen)
        and close(scored, rival)
    ]
    return min(simpler, key=lambda rival: (_unknowns(system, rival), -rival.total), default=scored)


def _unknowns(system: System, scored: Scored) -> int:
    """Number of its columns and the shape parameters of its effects."""
    shapes = (instance.effect.shape for i in scored.fit.chosen for instance in system.candidates[i].instances)
    return len(scored.fit.columns) + sum(map(len, shapes))


def _special_case(system: System, simple: Sequence[int], general: Sequence[int]) -> bool:
    """Whether the first set is the second with effects replaced by special cases of theirs."""
    out = [system.candidates[i] for i in general if i not in simple]
    into = [system.candidates[i] for i in simple if i not in general]
    return len(out) == len(into) and all(any(contains(whole, part) for whole in out) for part in into)


def contains(whole: Candidate, part: Candidate) -> bool:
    """Whether the second effect is declared a special case of the first."""
    return part.instances[0].effect.name in whole.instances[0].effect.contains


def possible(system: System, fit: SetFit) -> bool:
    """Whether the largest share of every effect with a required sign has it: no friction drives."""
    at = system.base
    for i in fit.chosen:
        candidate = system.candidates[i]
        signs = [
            parameter.positive for instance in candidate.instances for parameter in instance.effect.parameters
        ]
        values = fit.values[at : at + len(signs)]
        at += len(signs)
        signed = np.flatnonzero(signs)
        if not len(signed):
            continue
        share = (values * candidate.lengths)[signed]
        if share[np.argmax(np.abs(share))] < 0:
            return False
    return True
