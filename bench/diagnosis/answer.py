"""The answer of a diagnosis: a verdict on every effect, with probabilities."""

from collections.abc import Sequence
from dataclasses import replace

from bench.basics.deadline import TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.as_good import with_spread_over_models
from bench.diagnosis.ladder import errors_nearly_without, errors_without, step_of
from bench.diagnosis.mounting import mounted_otherwise
from bench.diagnosis.posterior import posterior_of, something_else
from bench.diagnosis.result import Diagnosis, LadderStep, Unfinished
from bench.diagnosis.search import held_out_error
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.values_by_log import with_elsewhere_noted
from bench.diagnosis.verdicts import ranking_of, verdicts
from bench.identification.identify import with_doubts_checked
from bench.identification.model_averaged import gains_model_averaged
from bench.identification.result import Identification


def answered(case: SplitProblem, finding: SearchResult, progress: Progress = SILENT) -> Diagnosis:
    """The result of a search, with a verdict on every effect."""
    progress.phase("judging every effect")
    model = finding.model
    after = with_doubts_checked(model, finding.after)
    system, best = finding.last.system, finding.last.selection
    scale = _relative(finding, after)
    unfinished = list(finding.unfinished)
    if Unfinished.SETS in unfinished:
        without = errors_nearly_without(finding.names, finding.last, scale)
    else:
        without = errors_without(finding.names, finding.fits)
    after = with_elsewhere_noted(model, after, case.problem.catalogue)
    remaining = finding.unexplained_by(case, after)
    if model.fit_gains:
        progress.phase("fitting models that are as good")
        try:
            after = with_spread_over_models(finding.base_model, finding.last, model, after, remaining)
        except TimeUpError:
            unfinished.append(Unfinished.AS_GOOD)
    if not finding.compared and not unfinished:
        finding = finding.compared_by_log(case)
    if finding.differently is not None and not {each.request for each in finding.differs} <= {*after.effects}:
        # values by recording also explain the data
        after = gains_model_averaged(after, [finding.differently])
    judged = verdicts(finding, scale, remaining, without)  # solves sets that the posterior includes
    posterior = posterior_of(system, best, finding.last.proposals, scale, remaining.excess)
    complete = Unfinished.SETS not in unfinished
    ranking = ranking_of(case, finding, after, judged, posterior, complete=complete)
    named = {*finding.names} - {*finding.usual}
    strongest = sorted(ranking, key=lambda verdict: -verdict.evidence)
    missing = tuple(verdict.effect for verdict in strongest if verdict.effect in named)
    return Diagnosis(
        robot=case.problem.dataset.robot.name,
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
    """A ladder that ends with the answer, which may have other payloads or less biased columns."""
    *steps, last = ladder
    return (*steps, step_of(last.effects, after.recordings)) if steps else (last,)


def _relative(finding: SearchResult, after: Identification) -> float:
    """Error of the converged model over that of its set in the system: it scales the errors of sets."""
    selected_error = held_out_error(finding.last.system, finding.last.selection.selected.fit)
    return (after.error.validate or 0.0) / selected_error if selected_error > 0 else 0.0
