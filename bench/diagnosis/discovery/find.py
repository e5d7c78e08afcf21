"""Diagnosis with the effects of a catalogue and, where these leave something, with laws that are in none."""

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


def _diagnosis(case: SplitProblem, discover: bool | None, believed: bool, progress: Progress) -> Diagnosis:
    """The diagnosis; believed: whether nothing speaks against how the data are declared.

    After the deadline the last answer that came to its end is given.
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
    """The answer where it is no worse than the usual friction; else one that is, without laws."""
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
    # friction that is not proven makes no gain surer
    after = gains_no_surer(diagnosis.after, best.diagnosis.after) if better.usual else diagnosis.after
    return AnswerWithLaws(better, (), replace(diagnosis, after=after))


def _without_laws(diagnosis: Diagnosis, discover: bool | None) -> Diagnosis:
    """An answer that says that laws were not looked for, or not to the end, unless none were to be."""
    missed = () if discover is False else (Unfinished.LAWS,)
    return replace(diagnosis, unfinished=(*diagnosis.unfinished, *missed))
