"""The answer of a diagnosis: a verdict on every effect, with probabilities."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bench.basics.deadline import TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.as_good import with_spread_over_models
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.compared import compared
from bench.diagnosis.elsewhere import differing_elsewhere
from bench.diagnosis.encoder_noise import encoder_error
from bench.diagnosis.ladder import errors_nearly_without, errors_without, step_of
from bench.diagnosis.mounting import mounted_otherwise
from bench.diagnosis.normal_equations import System
from bench.diagnosis.posterior import posterior_of, something_else, with_probability
from bench.diagnosis.pruning import refused
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, EffectVerdict, LadderStep, Unfinished
from bench.diagnosis.search import Selection, held_out_error
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.sizes import sizes_of
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import given_wholly
from bench.diagnosis.unexplained import unexplained
from bench.diagnosis.verdicts import undecided, verdicts
from bench.identification.errors_in_variables import with_errors_in_variables_checked
from bench.identification.findings import with_other_values
from bench.identification.identify import fit
from bench.identification.impossible_payload import with_possible_payloads
from bench.identification.model_averaged import gains_model_averaged
from bench.identification.result import Identification, relative_error


def answered(case: SplitProblem, finding: SearchResult, progress: Progress = SILENT) -> Diagnosis:
    """The result of a search, with a verdict on every effect."""
    progress.phase("judging every effect")
    dataset, start = case.problem.dataset, case.start
    model = finding.model
    after = with_errors_in_variables_checked(model, with_possible_payloads(model, finding.after, fit), fit)
    proposals, system, best = finding.last.proposals, finding.last.system, finding.last.selection
    places: dict[str, tuple[str, ...]] = {}
    for instance in finding.new:
        at = (instance.joint,) if instance.joint else dataset.robot.joints
        places[instance.effect.name] = (*places.get(instance.effect.name, ()), *at)
    scale = _relative(after, system, best)
    unfinished = list(finding.unfinished)
    if Unfinished.SETS in unfinished:
        without = errors_nearly_without(finding.names, finding.last, scale)
    else:
        without = errors_without(finding.names, finding.fits)
    others = differing_elsewhere(model, after, case.problem.catalogue)
    if others:
        after = with_other_values(after, [f"{effect}:{joint}" for effect, joint in sorted(others)])
    remaining = unexplained(after, dataset.recordings, lambda: encoder_error(model))
    if model.fit_gains:
        progress.phase("fitting models that are as good")
        try:
            after = with_spread_over_models(finding.base_model, finding.last, model, after, remaining)
        except TimeUpError:
            unfinished.append(Unfinished.AS_GOOD)
    if not finding.compared and not unfinished:
        finding = compared(case, finding)
    if finding.differently is not None and not {each.request for each in finding.differs} <= {*after.effects}:
        # values for each recording explain the data, too
        after = gains_model_averaged(after, [finding.differently])
    ranking = verdicts(
        system, proposals, best, _shown_places(proposals, best, places), scale, remaining, without
    )
    known = {*given_wholly(start.effects, proposals), *_shown_places(proposals, best, {})} - {*places}
    ranking = tuple(
        refused(verdict, finding.barred.get(verdict.effect))
        for verdict in ranking
        if verdict.effect not in known and not (Unfinished.SETS in unfinished and undecided(verdict))
    )
    posterior = posterior_of(system, best, proposals, scale, remaining.excess)
    probability = {proposals[i].name: float(posterior.probability[i]) for i in best.singles}
    ranking = tuple(
        with_probability(
            replace(verdict, size=sizes_of(model, after, verdict.effect)),
            probability.get(verdict.effect),
            posterior.sets,
            finding.names,
        )
        for verdict in ranking
    )
    ranking = tuple(
        replace(verdict, verdict="not supported", alternatives=(), why=Reason(Because.USUAL))
        if verdict.effect in finding.usual
        else verdict
        for verdict in ranking
    )
    named = {*places} - {*finding.usual}
    missing = tuple(verdict.effect for verdict in _by_strength(ranking) if verdict.effect in named)
    return Diagnosis(
        robot=dataset.robot.name,
        held_out=case.held_out,
        missing=missing,
        ladder=_ending_with(finding.ladder, after),
        ranking=ranking,
        unexplained=remaining,
        before=case.before,
        after=replace(after, findings=(*mounted_otherwise(model), *case.extrapolated, *after.findings)),
        differs=finding.differs,
        superfluous=finding.superfluous,
        unfinished=tuple(unfinished),
        sets=posterior.sets,
        something_else=something_else(posterior, system.samples, remaining),
    )


def _ending_with(ladder: Sequence[LadderStep], after: Identification) -> tuple[LadderStep, ...]:
    """A ladder whose last step is the answer, which may have other payloads or less biased columns."""
    *steps, last = ladder
    return (*steps, step_of(last.effects, after.recordings)) if steps else (last,)


def _relative(after: Identification, system: System, selection: Selection) -> float:
    """Error of the converged model over that of its set in the system, so that the errors of sets end where it does."""
    error = relative_error([trace for trace in after.recordings if trace.use == "validate"]) or 0.0
    selected_error = held_out_error(system, selection.selected.fit)
    return error / selected_error if selected_error > 0 else 0.0


def _shown_places(
    proposals: Sequence[Proposal], selection: Selection, places: Mapping[str, tuple[str, ...]]
) -> dict[str, tuple[str, ...]]:
    return {proposals[i].name: places.get(proposals[i].name, ()) for i in selection.selected.fit.chosen}


def _by_strength(ranking: Sequence[EffectVerdict]) -> list[EffectVerdict]:
    return sorted(ranking, key=lambda verdict: -verdict.evidence)
