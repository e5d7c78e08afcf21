"""Diagnosis with the effects of a catalogue and, if these leave an error, with laws outside it."""

from dataclasses import replace

from bench.basics.deadline import NEVER, Deadline, TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.diagnosis.answer import answered
from bench.diagnosis.catalogue_search import search_catalogue
from bench.diagnosis.completed import completed
from bench.diagnosis.discovery.with_laws import AnswerWithLaws, something_remains, with_more
from bench.diagnosis.result import Diagnosis, Unfinished
from bench.diagnosis.split_problem import SplitProblem, split_and_fitted
from bench.diagnosis.usual_friction import no_worse_than_usual
from bench.identification.finding import Finding, mended_first
from bench.identification.mistaken import mistaken, refuse_signs
from bench.identification.model_averaged import gains_no_surer
from bench.identification.problem import Problem


@on_one_thread
def find_missing_effects(
    problem: Problem, *, discover: bool | None = None, progress: Progress = SILENT, deadline: Deadline = NEVER
) -> Diagnosis:
    """Physical effects that the model lacks, and laws outside the catalogue, judged on recordings not fitted.

    discover: whether to search laws, by default if the effects leave an error. progress: receives the state of the
    search. deadline: after it the best answer so far is returned, and says what was not searched. Raises BenchError
    naming what is unusable in dataset or robot.

    Probably swapped columns and probably wrong loads are reported. With these, or with a drive gain that is ten times
    off, laws are searched only on request. A current of the wrong sign is refused.
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


def _diagnosis(case: SplitProblem, discover: bool | None, believed: bool, progress: Progress) -> Diagnosis:
    """The diagnosis; believed: whether the data agree with their declaration.

    After the deadline the last complete answer is returned.
    """
    finding = search_catalogue(case, progress)
    plain = answered(case, finding, progress)
    if finding.unfinished:
        return _without_laws(plain, discover)
    first = best = AnswerWithLaws(finding, (), plain)
    try:
        for better in with_more(case, best, discover, believed, progress):
            best = better
    except TimeUpError:
        return _without_laws(best.diagnosis, discover)
    best = _no_worse_than_usual(case, first, best, progress)
    progress.phase("looking at half of the band")
    return completed(best.finding, best.diagnosis)


def _no_worse_than_usual(
    case: SplitProblem, first: AnswerWithLaws, best: AnswerWithLaws, progress: Progress
) -> AnswerWithLaws:
    """The answer if no worse than the usual friction; else one that is not, without laws."""
    if not something_remains(best.diagnosis.unexplained):
        return best
    progress.phase("comparing with the usual friction")
    better = no_worse_than_usual(case, best.finding, best.diagnosis.after.error.validate or 0.0)
    if better is None:
        return best
    if best.laws:
        better = no_worse_than_usual(case, first.finding, first.diagnosis.after.error.validate or 0.0)
    if better is None:
        return first
    diagnosis = answered(case, better, progress)
    # unproven friction must not reduce standard errors of gains
    after = gains_no_surer(diagnosis.after, best.diagnosis.after) if better.usual else diagnosis.after
    return AnswerWithLaws(better, (), replace(diagnosis, after=after))


def _without_laws(diagnosis: Diagnosis, discover: bool | None) -> Diagnosis:
    """An answer that says that the search for laws is incomplete, unless none was requested."""
    missed = () if discover is False else (Unfinished.LAWS,)
    return replace(diagnosis, unfinished=(*diagnosis.unfinished, *missed))
