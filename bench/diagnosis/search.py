"""Search all small sets of effects for the one that the data support."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.diagnosis.batched_sets import enlarged, reduced, solve_sets, swapped
from bench.diagnosis.normal_equations import Candidate, SetFit, System, solve_set, squared_errors

EXHAUSTIVE = 3  # up to this size all sets of the shortlist compete; larger ones grow by one effect at a time
LARGEST_SET = 6
ALONE, BESIDE = (
    9,
    7,
)  # how many effects the shortlist has for what they do alone, and beside the best set so far
NEEDED = 10.0  # nats that an effect must bring (odds of some 20,000 to 1)
FEW = 8  # sets like another of which it is asked whether their effects earn their place
LITTLE = 0.2  # of a motor's error on judged recordings: an effect that leaves no more of it matters
MATERIAL = 0.03  # share of the error on judged recordings that an effect must take away


@dataclass(frozen=True)
class Scored:
    """A set with its evidence against the present model, in nats: on judged recordings, on fitted ones beyond what
    noise alone gives as many unknowns, and in all.
    """

    fit: SetFit
    judged: float
    fitted: float
    total: float


def score(system: System, fit: SetFit, reference: SetFit) -> Scored:
    """Log-likelihood ratios against `reference`, with as many samples as are independent.

    On judged recordings no parameter was fitted, so that it needs no penalty; on fitted ones half the logarithm
    of their number is subtracted for each parameter (Schwarz 1978). So are the priors of the set. Noise alone gives
    half a nat a parameter there (Wilks 1938). In all, every period of a motion that returns counts once, with the
    errors that return with it: recordings that were not fitted are no others than those that were, then.
    """
    tiny = np.finfo(float).tiny
    ratios = np.log((reference.by_motor + tiny) / (fit.by_motor + tiny))
    fitted = 0.5 * float(system.fitted.rows_of_motor @ ratios[0]) / system.memory
    judged = 0.5 * float(system.judged.rows_of_motor @ ratios[1]) / system.memory
    samples = system.fitted.rows / system.memory
    extra = len(fit.columns) - len(reference.columns)
    penalty = 0.5 * extra * np.log(max(samples / system.repeats, 1.0))
    penalty += system.prior_of(fit.chosen) - system.prior_of(reference.chosen)
    total = (judged + fitted) / system.repeats - penalty
    return Scored(fit, float(judged), float(fitted - 0.5 * extra), float(total))


@dataclass(frozen=True)
class Found:
    """The supported set, every single effect scored alone, and the model without any."""

    best: Scored
    singles: dict[int, Scored]
    empty: SetFit


def search(system: System, usable: Sequence[int], deadline: Deadline = NEVER) -> Found:
    """The supported set among the usable candidates (indices).

    A larger set wins only if each of its effects earns NEEDED nats and MATERIAL of the error on recordings that
    were not fitted, and if none of its effects has an impossible sign. All pairs and triples of the shortlist
    compete, so that a first choice that a better pair makes superfluous does not stay. Raises TimeUpError after the
    deadline.
    """
    empty = solve_set(system, ())
    alone = solve_sets(system, [(i,) for i in usable])
    singles = {i: score(system, fit, empty) for i, fit in zip(usable, alone, strict=True)}
    best = score(system, empty, empty)
    for size in range(1, LARGEST_SET + 1):
        deadline.check()
        order = _shortlist(system, usable, singles, best, empty)
        if size <= EXHAUSTIVE:
            sets = list(combinations(order, size))
        else:
            sets = [(*best.fit.chosen, i) for i in order if i not in best.fit.chosen]
        scored = [score(system, fit, empty) for fit in solve_sets(system, sets)]
        able = [
            scored_law
            for scored_law in sorted(scored, key=lambda candidate: -candidate.total)
            if possible(system, scored_law.fit)
        ]
        before = best
        for candidate in able[:20]:
            if candidate.total > best.total + NEEDED and earned(system, candidate, empty):
                best = simplest(system, candidate, able)
                break
        if size >= EXHAUSTIVE and best is before:
            break
    return Found(best, singles, empty)


def neighbours(system: System, found: Found, chosen: tuple[int, ...], usable: Sequence[int]) -> list[Scored]:
    """Sets with one effect more than the chosen one, another or one less, the best first: those of which every effect
    earns its place.
    """
    others = [i for i in usable if i not in chosen]
    sets = enlarged(chosen, others) + swapped(chosen, others)
    if len(chosen) > 1:
        sets += reduced(chosen)
    here = score(system, solve_set(system, chosen), found.empty)
    scored = (score(system, fit, found.empty) for fit in solve_sets(system, sets))
    best = sorted(
        (s for s in scored if s.total > here.total + NEEDED and possible(system, s.fit)),
        key=lambda s: -s.total,
    )
    return [s for s in best[:FEW] if earned(system, s, found.empty)]


def _shortlist(
    system: System, usable: Sequence[int], singles: dict[int, Scored], best: Scored, empty: SetFit
) -> list[int]:
    """Effects that explain most alone, and most beside the best set so far: one may hide the other."""
    chosen = best.fit.chosen
    alone = sorted(usable, key=lambda i: -singles[i].total)[:ALONE]
    others = [i for i in usable if i not in chosen]
    wider = solve_sets(system, enlarged(chosen, others)) if chosen else []
    beside = {i: score(system, fit, empty).total for i, fit in zip(others, wider, strict=False)}
    return list(dict.fromkeys([*chosen, *alone, *sorted(beside, key=lambda i: -beside[i])[:BESIDE]]))


def earned(system: System, scored: Scored, empty: SetFit) -> bool:
    """Whether the set is clearly poorer without any of its effects, on recordings that were not fitted, and on fitted
    ones: where those say nothing of an effect, what it does elsewhere makes up for errors of the other parameters.
    """
    chosen = scored.fit.chosen
    for i in range(len(chosen)):
        fewer = solve_set(system, chosen[:i] + chosen[i + 1 :])
        without = score(system, fewer, empty)
        gained = (
            scored.judged - without.judged,
            scored.fitted - without.fitted,
            scored.total - without.total,
        )
        if min(gained) < NEEDED:
            return False
        if not (material(fewer, scored.fit) or little_left_at_a_motor(fewer, scored.fit)):
            return False
    return True


def judged_error(system: System, fit: SetFit) -> float:
    """Relative error of a set on the recordings that were not fitted: RMS(error) / RMS(measured), all motors."""
    measured = system.judged.measured
    error = squared_errors(system.judged, fit, system.start)
    return float(np.sqrt(error.sum() / measured)) if measured else 0.0


def little_left_at_a_motor(before: SetFit, after: SetFit) -> bool:
    """Whether little of the error of one motor is left on recordings that were not fitted.

    Each motor's error is weighted by what the present model leaves there of the fitted recordings: where that is far
    more than of others, all that goes there is little of the whole.
    """
    return bool(np.any(after.by_motor[1] <= LITTLE**2 * before.by_motor[1]))


def material(before: SetFit, after: SetFit) -> bool:
    """Whether the error on recordings that were not fitted falls by more than MATERIAL."""
    return bool(np.sqrt(after.judged) < (1.0 - MATERIAL) * np.sqrt(before.judged))


def close(scored: Scored, other: Scored) -> bool:
    """Whether the data cannot tell two sets apart: the second is hardly worse than the first."""
    return scored.judged - other.judged < NEEDED or not material(other.fit, scored.fit)


def simplest(system: System, scored: Scored, rivals: Sequence[Scored]) -> Scored:
    """Of the sets that are as good and hold a special case of an effect instead of it, the one with fewest unknowns."""
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
    """Its columns, and the shape parameters of its effects."""
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
    """Whether the largest share of every effect that has a sign has the right one: no friction that drives."""
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
