"""Diagnosis with the effects of a catalogue and, where these leave something, with laws that are in none."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from bench.basics.deadline import NEVER, Deadline, TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.diagnosis.answer import answered
from bench.diagnosis.base_model import BaseModel
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.catalogue_search import search_catalogue
from bench.diagnosis.completed import completed
from bench.diagnosis.discovery.called import stood_for
from bench.diagnosis.discovery.discovered_at import discovered_at
from bench.diagnosis.discovery.doubted import doubted
from bench.diagnosis.discovery.laws import Law, laws_of
from bench.diagnosis.discovery.merged import merged
from bench.diagnosis.discovery.refine import Judge, Refined
from bench.diagnosis.discovery.search import Laws, search_laws
from bench.diagnosis.discovery.seen import places_of
from bench.diagnosis.discovery.smooth import tabled_laws
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import (
    Diagnosis,
    EffectVerdict,
    Unexplained,
    Unfinished,
)
from bench.diagnosis.rounds import Round, round_about, usable
from bench.diagnosis.search import best_set
from bench.diagnosis.search_from import search_from
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.signs import refuse_signs
from bench.diagnosis.split_problem import SplitProblem, split_and_fitted
from bench.diagnosis.usual_friction import judged_error, no_worse_than_usual
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.finding import Finding, mended_first
from bench.identification.identify import fit
from bench.identification.mistaken import mistaken
from bench.identification.model_averaged import gains_model_averaged, gains_no_surer
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.tolerances import TOLERANCES


@on_one_thread
def find_missing_effects(
    problem: Problem,
    *,
    discover: bool | None = None,
    progress: Progress = SILENT,
    deadline: Deadline = NEVER,
) -> Diagnosis:
    """Physical effects that the model lacks, and laws that no catalogue has, judged on recordings not fitted.

    discover: whether to look for laws, by default where the effects leave something. progress: informed how far the
    search is. deadline: after which the best answer so far is given, and says what was not looked at. Raises
    BenchError naming what in dataset or robot cannot be used.

    Columns that are probably swapped and loads that are probably others are reported. Unless that is asked for, no law
    is looked for with them, nor with a drive gain that is ten times off. A current of the wrong sign is refused.
    """
    case = split_and_fitted(problem, progress, deadline)
    progress.phase("looking for swapped columns and loads")
    causes: tuple[Finding, ...] = ()
    unfinished: tuple[Unfinished, ...] = ()
    try:
        whole = case.start if not (case.held_out or case.start.effects) else None
        causes = mistaken(problem, case.before, whole, deadline)
    except TimeUpError:
        unfinished = (Unfinished.CAUSES,)
    refuse_signs(problem.dataset.folder, causes, case.before)
    diagnosis = _diagnosis(case, discover, not causes, progress)
    return replace(
        diagnosis,
        after=replace(diagnosis.after, findings=mended_first((*causes, *diagnosis.after.findings))),
        unfinished=(*unfinished, *diagnosis.unfinished),
    )


@dataclass(frozen=True)
class _Answer:
    """The identified effects and laws, and the messages about them."""

    finding: SearchResult
    laws: tuple[Law, ...]
    diagnosis: Diagnosis


def _diagnosis(case: SplitProblem, discover: bool | None, believed: bool, progress: Progress) -> Diagnosis:
    """The diagnosis; believed: whether nothing speaks against how the data are declared.

    After the deadline the last answer that came to its end is given.
    """
    finding = search_catalogue(case, progress)
    plain = answered(case, finding, progress)
    if finding.unfinished:
        return _without_laws(plain, discover)
    first = best = _Answer(finding, (), plain)
    try:
        for better in _with_more(case, best, discover, believed, progress):
            best = better
    except TimeUpError:
        return _without_laws(best.diagnosis, discover)
    best = _no_worse_than_usual(case, first, best, progress)
    progress.phase("looking at half of the band")
    return completed(best.finding, best.diagnosis)


def _no_worse_than_usual(case: SplitProblem, first: _Answer, best: _Answer, progress: Progress) -> _Answer:
    """The answer where it is no worse than the usual friction; else one that is, without laws."""
    if not something_remains(best.diagnosis.unexplained):
        return best
    progress.phase("comparing with the usual friction")
    better = no_worse_than_usual(case, best.finding, judged_error(best.diagnosis.after))
    if better is None:
        return best
    if best.laws:
        better = no_worse_than_usual(case, first.finding, judged_error(first.diagnosis.after))
    if better is None:
        return first
    diagnosis = answered(case, better, progress)
    # friction that is not proven makes no gain surer
    after = gains_no_surer(diagnosis.after, best.diagnosis.after) if better.usual else diagnosis.after
    return _Answer(better, (), replace(diagnosis, after=after))


def _without_laws(diagnosis: Diagnosis, discover: bool | None) -> Diagnosis:
    """An answer that says that laws were not looked for, or not to the end, unless none were to be."""
    missed = () if discover is False else (Unfinished.LAWS,)
    return replace(diagnosis, unfinished=(*diagnosis.unfinished, *missed))


def _with_more(
    case: SplitProblem, plain: _Answer, discover: bool | None, believed: bool, progress: Progress
) -> Iterator[_Answer]:
    """Answers that are better, one after the other: with laws, with one for several, with tables."""
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
    """Effects that may not be named with a law either: what is not needed, or improbable, without one may be needed
    with it.
    """
    passing = (Because.NOT_NEEDED, Because.GAINS_LITTLE)
    return {name: why for name, why in finding.barred.items() if why.because not in passing}


def _never_with_laws(finding: SearchResult, named: Sequence[EffectInstance]) -> dict[str, Reason]:
    """The same with laws that were identified with named effects: their special cases may be selected where their sign
    was impossible at some motors alone, for what drove there may have been the law.
    """
    specials = {special for instance in named for special in instance.effect.contains}
    return {
        name: why
        for name, why in _never(finding).items()
        if name not in specials or why.because is not Because.IMPOSSIBLE or len(why.names) == 1
    }


def something_remains(unexplained: Unexplained) -> bool:
    """Whether there is enough beyond the noise to look for laws in."""
    return unexplained.significant or unexplained.error > RULE.beyond_noise * hypot(
        unexplained.noise_floor, unexplained.encoders
    )


def _with_laws(
    case: SplitProblem,
    plain: _Answer,
    searched: Laws,
    refined: Refined,
    progress: Progress,
    prior: float | None = None,
) -> _Answer:
    """The answer with the laws that were identified, converged and judged with all effects; without, if they do not
    stay.

    prior: of the laws, by default that of the terms they were selected with.
    """
    base_model, last = plain.finding.base_model, searched.last
    given_count = len(base_model.start.effects)
    result = fit(refined.model)
    laws = laws_of(
        result,
        refined.model.effects[given_count:],
        refined.terms,
        places_of(base_model.start),
        case.problem.catalogue,
    )
    named = [
        instance
        for instance in refined.model.effects[given_count:]
        if instance.effect.name not in refined.terms
    ]
    model = base_model.with_instances([*named, *(instance for law in laws for instance in law.instances)])
    if prior is None:
        prior = max(proposal.prior for proposal in last.proposals)
    proposals = [
        _as_in(model, proposal) for proposal in last.proposals if proposal.name not in searched.terms
    ]
    proposals += _proposed(model, laws, prior)
    barred = _never_with_laws(plain.finding, named)
    this_round = _round_from(base_model, model, proposals, barred)
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
        this_round = _round_from(
            base_model, model, [proposal for proposal in proposals if proposal.name not in called], barred
        )
    if not called and this_round.names.isdisjoint(law.name for law in laws):
        return plain
    finding = search_from(case, base_model, this_round, progress, barred, wholly=True)
    staying = tuple(law for law in laws if law.name in finding.names)
    if not (staying or called):
        return plain
    needed = (
        RULE.sure_odds if staying else 0.0
    )  # what the catalogue holds is preferred to a law that is not sure
    if finding.odds_over(plain.finding, plain.diagnosis.unexplained.excess) <= needed:
        return plain
    return _Answer(
        finding, staying, _with_discovered(finding, staying, laws, answered(case, finding, progress))
    )


def _round_from(
    base_model: BaseModel, model: Prepared, proposals: Sequence[Proposal], barred: Collection[str]
) -> Round:
    """As `round_about`; the search also starts from the model's set: of laws at one motor each, none shows alone."""
    this_round = round_about(base_model, model, proposals, barred)
    there = {instance.effect.name for instance in model.effects[len(base_model.start.effects) :]}
    known = usable(proposals, barred)
    begun = [i for i in known if proposals[i].name in there]
    best = best_set(this_round.system, [begun, this_round.chosen], known, base_model.deadline)
    return (
        replace(this_round, selection=replace(this_round.selection, selected=best))
        if best.total > this_round.selection.selected.total
        else this_round
    )


def _with_one_for_several(case: SplitProblem, plain: _Answer, progress: Progress) -> _Answer:
    """The answer with one law for several frictions, where that has fewer unknowns and leaves as little."""
    progress.phase("trying one law for several frictions")
    finding, unexplained = plain.finding, plain.diagnosis.unexplained
    much = (1.0 - RULE.material) * unexplained.error > hypot(unexplained.noise_floor, unexplained.encoders)
    prior = RULE.prior + float(np.log(TOLERANCES.laws.merged_laws))
    searched = Laws(finding.last, {law.name: law.terms[0] for law in plain.laws})
    judge = Judge(finding.last.system.samples, prior)
    for single in merged(finding, plain.laws, case.problem.catalogue, judge, much=much):
        answer = _with_laws(case, plain, searched, single, progress, prior=prior)
        if answer is not plain:
            return _with_one_for_several(case, answer, progress)
    return plain


def _with_tables(case: SplitProblem, plain: _Answer, progress: Progress) -> _Answer:
    """The answer with functions as they were measured, where much remains that no formula fits.

    They compete only with the identified model: what the effects of the catalogue are worth has been judged before, and
    where more than noise remains with them, too, they must explain a share of it. A table is no law: the gains'
    standard errors hold what they are without it, where they have not run away there.
    """
    finding, unexplained = plain.finding, plain.diagnosis.unexplained
    if not (unexplained.significant or unexplained.much):
        return plain
    progress.phase("tabling what no formula fits")
    base_model = finding.base_model
    given_count = len(base_model.start.effects)
    laws = tabled_laws(finding, {*case.problem.catalogue, *(law.name for law in plain.laws)})
    if not laws:
        return plain
    instances = [
        *finding.model.effects[given_count:],
        *(instance for law in laws for instance in law.instances),
    ]
    model = base_model.with_instances(instances)
    proposals = [proposal for proposal in finding.last.proposals if proposal.name in finding.names]
    proposals += _proposed(model, laws, RULE.prior)
    this_round = _round_from(base_model, model, proposals, finding.barred)
    if this_round.names.isdisjoint(law.name for law in laws):
        return plain
    wider = search_from(case, base_model, this_round, progress, finding.barred, wholly=True)
    staying = tuple(law for law in (*plain.laws, *laws) if law.name in wider.names)
    tabled = {law.name for law in laws}.intersection(wider.names)
    if not tabled or wider.odds_over(finding, wider.excess(case)) <= 0.0:
        return plain
    diagnosis = _with_discovered(wider, staying, (*plain.laws, *laws), answered(case, wider, progress))
    diagnosis = replace(diagnosis, after=gains_model_averaged(diagnosis.after, [plain.diagnosis.after]))
    judged_before = {verdict.effect for verdict in diagnosis.ranking}
    others = tuple(verdict for verdict in plain.diagnosis.ranking if verdict.effect not in judged_before)
    return _Answer(wider, staying, replace(diagnosis, ranking=(*diagnosis.ranking, *others)))


def _proposed(model: Prepared, laws: Sequence[Law], prior: float) -> list[Proposal]:
    """Laws as a converged model has them, as proposals."""
    return [
        Proposal(
            law.name,
            tuple(instance for instance in model.effects if instance.effect.name == law.name),
            False,
            "",
            prior,
        )
        for law in laws
    ]


def _as_in(model: Prepared, proposal: Proposal) -> Proposal:
    """A proposal in the shape that it has in a model, where it is there."""
    there = {instance.joint: instance for instance in model.effects if instance.effect.name == proposal.name}
    instances = tuple(there.get(instance.joint, instance) for instance in proposal.instances)
    return replace(proposal, instances=instances)


def _with_discovered(
    finding: SearchResult, laws: Sequence[Law], tried: Sequence[Law], diagnosis: Diagnosis
) -> Diagnosis:
    """The laws as what was discovered, and the catalogue's names as what is missing. tried: laws that competed."""
    names = {law.name: () for law in tried} | {
        law.name: tuple(place.name for place in law.places if _stays_at(finding, law, place)) for law in laws
    }
    ranking = tuple(_without(verdict, names) for verdict in diagnosis.ranking if verdict.effect not in names)
    ranking = doubted(finding, laws, ranking, diagnosis.unexplained)
    return replace(
        diagnosis,
        missing=tuple(name for name in diagnosis.missing if name not in names),
        ranking=ranking,
        discovered=tuple(
            discovered_at(finding, law, i)
            for law in laws
            for i, place in enumerate(law.places)
            if _stays_at(finding, law, place)
        ),
    )


def _stays_at(finding: SearchResult, law: Law, place: Place) -> bool:
    """Whether a law that stays has stayed at a place: it goes from those where it is nothing."""
    return place.name in finding.after.effect_parameters[law.name]


def _without(verdict: EffectVerdict, laws: Mapping[str, Sequence[str]]) -> EffectVerdict:
    """A verdict that names effects of the catalogue alone. laws: by name the motors at which they stay.

    Indistinguishable is what has an alternative of the catalogue. An effect that does as well as laws alone resembles
    what they say; an identified one for which nothing but a law could stand is as sure as it is without that.
    """
    others = tuple(name for name in verdict.alternatives if name not in laws)
    if others or not verdict.alternatives:
        return replace(verdict, alternatives=others)
    if verdict.why.because is Because.AS_GOOD:
        places = dict.fromkeys(place for name in verdict.alternatives for place in laws[name])
        why = Reason(Because.AS_GOOD_AS_A_LAW, tuple(places), verdict.why.doubts)
        return replace(verdict, alternatives=(), verdict="resembles", why=why)
    return replace(verdict, alternatives=(), verdict="resembles" if verdict.why.doubts else "missing")
