"""Answers with laws outside the catalogue: single terms, one law for several frictions, tables."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from bench.basics.progress import Progress
from bench.diagnosis.answer import answered
from bench.diagnosis.base_model import added_effects
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.discovery.laws import Law, laws_of
from bench.diagnosis.discovery.merged import merged
from bench.diagnosis.discovery.refine import Judge, Refined
from bench.diagnosis.discovery.reported import stood_for, with_discovered
from bench.diagnosis.discovery.search import Laws, search_laws
from bench.diagnosis.discovery.smooth import tabled_laws
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, Unexplained
from bench.diagnosis.rounds import round_from
from bench.diagnosis.search_from import search_from
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.split_problem import SplitProblem
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.model_averaged import gains_model_averaged
from bench.identification.prepare import Prepared
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class AnswerWithLaws:
    """The identified effects and laws, and their diagnosis. tried: laws that competed, including these."""

    finding: SearchResult
    laws: tuple[Law, ...]
    diagnosis: Diagnosis
    tried: tuple[Law, ...] = ()


def with_more(
    case: SplitProblem, plain: AnswerWithLaws, discover: bool | None, believed: bool, progress: Progress
) -> Iterator[AnswerWithLaws]:
    """Better and better answers: with laws, with one for several, with tables."""
    finding, answer = plain.finding, plain
    gains = plain.diagnosis.after.drive_gains.values()
    factor = TOLERANCES.findings.unit_of_gain
    believed = believed and all(1.0 / factor <= gain.value / gain.nominal <= factor for gain in gains)
    wanted = something_remains(plain.diagnosis.unexplained)
    if discover is None and not believed:
        return
    if discover is not False and not wanted:
        answer = _with_one_for_several(case, answer, progress)
        yield answer
    if answer.laws or not (wanted if discover is None else discover):
        return
    discovered_laws = search_laws(finding.base_model, finding.last, _never(finding), progress)
    if discovered_laws is not None:
        answer = _with_laws(case, answer, *discovered_laws, progress)
        yield answer
    if answer.laws or wanted:
        answer = _with_one_for_several(case, answer, progress)
        yield answer
    yield _with_tables(case, answer, progress)


def _never(finding: SearchResult) -> dict[str, Reason]:
    """Effects that remain barred with a law: effects that are not needed, or improbable, without one may be needed with
    it.
    """
    passing = (Because.NOT_NEEDED, Because.GAINS_LITTLE)
    return {name: why for name, why in finding.barred.items() if why.because not in passing}


def _never_with_laws(finding: SearchResult, named: Sequence[EffectInstance]) -> dict[str, Reason]:
    """The same with laws that were identified with named effects: special cases of these with an impossible sign at
    only some motors may be selected, since the law may have caused the sign.
    """
    specials = {special for instance in named for special in instance.effect.contains}
    return {
        name: why
        for name, why in _never(finding).items()
        if name not in specials or why.because is not Because.IMPOSSIBLE or len(why.names) == 1
    }


def something_remains(unexplained: Unexplained) -> bool:
    """Whether the error beyond noise suffices to search laws."""
    return unexplained.significant or unexplained.error > RULE.beyond_noise * hypot(
        unexplained.noise_floor, unexplained.encoders
    )


def _with_laws(
    case: SplitProblem,
    plain: AnswerWithLaws,
    searched: Laws,
    refined: Refined,
    progress: Progress,
    prior: float | None = None,
) -> AnswerWithLaws:
    """The answer with the identified laws, converged and judged with all effects; without laws, if they do not stay.

    prior: of the laws, by default that of their terms.
    """
    base_model, last = plain.finding.base_model, searched.last
    laws = laws_of(base_model, refined, case.problem.catalogue)
    named = [each for each in added_effects(base_model, refined.model) if each.name not in refined.terms]
    model = base_model.with_instances([*named, *(instance for law in laws for instance in law.instances)])
    if prior is None:
        prior = max(proposal.prior for proposal in last.proposals)
    proposals = [
        _as_in(model, proposal) for proposal in last.proposals if proposal.name not in searched.terms
    ]
    proposals += _proposed(model, laws, prior)
    barred = _never_with_laws(plain.finding, named)
    this_round = round_from(base_model, model, proposals, barred)
    called = stood_for(this_round, [law.name for law in laws], barred)
    if called:
        laws = [law for law in laws if law.name not in called]
        named += [
            instance
            for i, proposal in enumerate(proposals)
            if i in called.values()
            for instance in proposal.instances
        ]
        model = base_model.with_instances([*named, *(instance for law in laws for instance in law.instances)])
        this_round = round_from(
            base_model, model, [proposal for proposal in proposals if proposal.name not in called], barred
        )
    if not called and this_round.names.isdisjoint(law.name for law in laws):
        return plain
    finding = search_from(case, base_model, this_round, progress, barred, wholly=True)
    staying = tuple(law for law in laws if law.name in finding.names)
    if not (staying or called):
        return plain
    needed = RULE.sure_odds if staying else 0.0  # the catalogue is preferred to an uncertain law
    if finding.odds_over(plain.finding, plain.diagnosis.unexplained.excess) <= needed:
        return plain
    diagnosis = with_discovered(finding, staying, laws, answered(case, finding, progress))
    return AnswerWithLaws(finding, staying, diagnosis, tuple(laws))


def _with_one_for_several(case: SplitProblem, plain: AnswerWithLaws, progress: Progress) -> AnswerWithLaws:
    """The answer with one law for several frictions, if it has fewer unknowns and as small an error."""
    progress.phase("trying one law for several frictions")
    finding, unexplained = plain.finding, plain.diagnosis.unexplained
    much = (1.0 - RULE.material) * unexplained.error > hypot(unexplained.noise_floor, unexplained.encoders)
    prior = RULE.prior + float(np.log(TOLERANCES.laws.merged_laws))
    searched = Laws(finding.last, {law.name: law.terms[0] for law in plain.tried})
    judge = Judge(finding.last.system.samples, prior)
    for single in merged(finding, plain.laws, case.problem.catalogue, judge, much=much):
        answer = _with_laws(case, plain, searched, single, progress, prior=prior)
        if answer is not plain:
            return _with_one_for_several(case, answer, progress)
    return plain


def _with_tables(case: SplitProblem, plain: AnswerWithLaws, progress: Progress) -> AnswerWithLaws:
    """The answer with measured functions, if much remains that no formula fits.

    They compete only with the identified model, since the catalogue has been judged before; if more than noise remains
    with them, they must explain a share of the error. A table is no law: standard errors of gains cover the gains
    without it, unless those have run away.
    """
    finding, unexplained = plain.finding, plain.diagnosis.unexplained
    if not (unexplained.significant or unexplained.much):
        return plain
    progress.phase("tabling what no formula fits")
    base_model = finding.base_model
    laws = tabled_laws(finding, {*case.problem.catalogue, *(law.name for law in plain.laws)})
    if not laws:
        return plain
    instances = [
        *added_effects(base_model, finding.model),
        *(instance for law in laws for instance in law.instances),
    ]
    model = base_model.with_instances(instances)
    proposals = [proposal for proposal in finding.last.proposals if proposal.name in finding.names]
    proposals += _proposed(model, laws, RULE.prior)
    this_round = round_from(base_model, model, proposals, finding.barred)
    if this_round.names.isdisjoint(law.name for law in laws):
        return plain
    wider = search_from(case, base_model, this_round, progress, finding.barred, wholly=True)
    staying = tuple(law for law in (*plain.laws, *laws) if law.name in wider.names)
    tabled = {law.name for law in laws}.intersection(wider.names)
    if not tabled or wider.odds_over(finding, wider.excess(case)) <= 0.0:
        return plain
    diagnosis = with_discovered(wider, staying, (*plain.laws, *laws), answered(case, wider, progress))
    diagnosis = replace(diagnosis, after=gains_model_averaged(diagnosis.after, [plain.diagnosis.after]))
    judged_before = {verdict.effect for verdict in diagnosis.ranking}
    others = tuple(verdict for verdict in plain.diagnosis.ranking if verdict.effect not in judged_before)
    return AnswerWithLaws(wider, staying, replace(diagnosis, ranking=(*diagnosis.ranking, *others)))


def _proposed(model: Prepared, laws: Sequence[Law], prior: float) -> list[Proposal]:
    """Laws as proposals, as in a converged model."""
    return [
        Proposal(
            law.name,
            tuple(instance for instance in model.effects if instance.name == law.name),
            False,
            "",
            prior,
        )
        for law in laws
    ]


def _as_in(model: Prepared, proposal: Proposal) -> Proposal:
    """A proposal in the shape that it has in a model, if it is there."""
    there = {instance.joint: instance for instance in model.effects if instance.name == proposal.name}
    instances = tuple(there.get(instance.joint, instance) for instance in proposal.instances)
    return replace(proposal, instances=instances)
