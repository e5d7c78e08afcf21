"""A verdict on every effect of the catalogue, with its reason."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bench.diagnosis.batched_sets import solve_sets, swapped
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.posterior import Posterior, with_probability
from bench.diagnosis.pruning import refused
from bench.diagnosis.reason import Because, Doubt, Reason
from bench.diagnosis.result import EffectVerdict, Unexplained, Verdict
from bench.diagnosis.round import Round
from bench.diagnosis.search import Scored, close, contains, held_out_error, possible, score_set
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import given_wholly
from bench.diagnosis.system import System
from bench.identification.decision import RULE
from bench.identification.effect_torques import sizes_of
from bench.identification.result import Identification

ORDER: Mapping[Verdict, int] = {
    "missing": 0,
    "indistinguishable": 1,
    "resembles": 2,
    "not supported": 3,
    "absorbed": 4,
}


def verdicts(
    finding: SearchResult, scale: float, unexplained: Unexplained, without: Mapping[str, float]
) -> list[EffectVerdict]:
    """Every effect, the identified ones first, then by evidence.

    scale: error of the converged model over that of its set. without: error of the identified model without each of its
    effects, fitted again. unexplained: if significant, no effect explains it, and an identified effect is only certain
    if the error without it is RULE.dominant times the residual with it, or RULE.dominant_in_much times if much remains.
    """
    last = finding.last
    system, best = last.system, last.selection.selected
    others = [i for i in last.selection.singles if i not in last.chosen]
    more = [(*last.chosen, i) for i in others]
    solve_sets(system, [*more, *swapped(last.chosen, others)])  # together, and kept for use below
    sure = (RULE.dominant_in_much if unexplained.much else RULE.dominant) if unexplained.significant else 0.0
    places: dict[str, tuple[str, ...]] = {}
    for instance in finding.new:
        at = (instance.joint,) if instance.joint else finding.model.dataset.robot.joints
        places[instance.name] = tuple(dict.fromkeys((*places.get(instance.name, ()), *at)))
    rows: list[EffectVerdict] = []
    for i, proposal in enumerate(last.proposals):
        if proposal.absorbed:
            rows.append(_absorbed(proposal, _error(system, best, scale)))
        elif i in last.chosen:
            shown, error = places.get(proposal.name, ()), without.get(proposal.name, 0.0)
            rows.append(_identified(last, i, shown, scale, sure, error))
        else:
            rows.append(_other(last, i, scale))
    names = last.names

    def order(verdict: EffectVerdict) -> tuple[bool, int, float, str]:
        return verdict.effect not in names, ORDER[verdict.verdict], -verdict.evidence, verdict.effect

    return sorted(rows, key=order)


def ranking_of(
    case: SplitProblem,
    finding: SearchResult,
    after: Identification,
    judged: Sequence[EffectVerdict],
    posterior: Posterior,
    *,
    complete: bool,
) -> tuple[EffectVerdict, ...]:
    """The verdicts with sizes and probabilities, and why effects were refused.

    after: answer of the identified model. complete: whether all sets were searched.
    """
    proposals, new = finding.last.proposals, {instance.name for instance in finding.new}
    known = {*given_wholly(case.start.effects, proposals), *finding.last.names} - new
    probability = {proposals[i].name: float(posterior.probability[i]) for i in finding.last.selection.singles}
    ranking = []
    for verdict in judged:
        name = verdict.effect
        if name in known or not (complete or not undecided(verdict)):
            continue
        said = refused(verdict, finding.barred.get(name))
        said = replace(said, size=sizes_of(finding.model, after, name))
        said = with_probability(said, probability.get(name), posterior.sets, finding.names)
        if name in finding.usual:
            said = replace(said, verdict="not supported", alternatives=(), why=Reason(Because.USUAL))
        ranking.append(said)
    return tuple(ranking)


def undecided(verdict: EffectVerdict) -> bool:
    """Whether an effect explains so much of the residual that only a complete search can decide on it."""
    return verdict.why.because is Because.GAINS_LITTLE and verdict.evidence > RULE.prior


def _error(system: System, scored: Scored, scale: float) -> float:
    return scale * held_out_error(system, scored.fit)


def _absorbed(proposal: Proposal, error: float) -> EffectVerdict:
    names = (proposal.taken_up_by,) if proposal.taken_up_by else ()
    why = Reason(Because.TAKEN_UP, names)
    return EffectVerdict(proposal.name, "absorbed", error, error, 0.0, (), (), {}, why)


def _as_good(system: System, best: Scored, chosen: Sequence[int]) -> bool:
    """Whether a set has possible signs and is hardly less probable than the best."""
    other = score_set(system, chosen)
    return close(best, other) and possible(system, other.fit)


def _identified(
    last: Round, i: int, places: tuple[str, ...], scale: float, sure: float, before: float
) -> EffectVerdict:
    system, best = last.system, last.selection.selected
    others = tuple(k for k in last.chosen if k != i)
    without = score_set(system, others)
    alternatives = [
        last.proposals[k].name
        for k in last.selection.singles
        if k not in last.chosen
        and not contains(system.candidates[k], system.candidates[i])
        and _as_good(system, best, (*others, k))
    ]
    after = _error(system, best, scale)
    unsure = without.fit.held_out < sure**2 * best.fit.held_out
    why = Reason(Because.EXPLAINS, doubts=(Doubt.MUCH_LEFT,) if unsure else ())
    verdict: Verdict = "indistinguishable" if alternatives else "resembles" if unsure else "missing"
    evidence, name = best.held_out - without.held_out, last.proposals[i].name
    return EffectVerdict(name, verdict, before, after, evidence, places, tuple(alternatives), {}, why)


def _other(last: Round, i: int, scale: float) -> EffectVerdict:
    system, best, name = last.system, last.selection.selected, last.proposals[i].name
    added = score_set(system, (*last.chosen, i))
    before, after = _error(system, best, scale), _error(system, added, scale)
    evidence = added.held_out - best.held_out
    rivals = tuple(
        last.proposals[k].name
        for k in last.chosen
        if not contains(system.candidates[i], system.candidates[k])
        and _as_good(system, best, (*(c for c in last.chosen if c != k), i))
    )
    if rivals:
        why = Reason(Because.AS_GOOD)
        return EffectVerdict(name, "indistinguishable", before, after, evidence, (), rivals, {}, why)
    nothing = after >= before or added.total + RULE.prior < best.total
    why = Reason(Because.GAINS_NOTHING if nothing else Because.GAINS_LITTLE)
    return EffectVerdict(name, "not supported", before, after, evidence, (), (), {}, why)
