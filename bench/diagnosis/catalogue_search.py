"""Which effects of the catalogue a model lacks, judged on recordings that were not fitted."""

from dataclasses import replace

from bench.basics.progress import SILENT, Progress
from bench.diagnosis.base_model import base_model_of
from bench.diagnosis.evidence import answer_weight
from bench.diagnosis.fading import not_asked
from bench.diagnosis.result import Unfinished
from bench.diagnosis.rounds import first_round
from bench.diagnosis.search_from import search_from
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import origins_of
from bench.diagnosis.values_by_log import (
    Place,
    differing_elsewhere,
    explains_more,
    leading,
    places_of,
    with_values_by_log,
    worse_elsewhere,
)
from bench.identification.identify import fit
from bench.identification.prepare import Prepared
from bench.identification.result import Identification
from bench.identification.tolerances import TOLERANCES


def search_catalogue(case: SplitProblem, progress: Progress = SILENT) -> SearchResult:
    """Search from the starting model; if values by recording, fitted or not, remove most of a motor's error, search
    with these.

    One value for all recordings, if values differ, moves the gains and looks like other effects. The answer has values
    by recording if, with the effects identified with them, they explain clearly more of parts that are not fitted, no
    less of other recordings (with best-fitting values), and still differ. After the deadline the answer is the best so
    far.
    """
    plain = _search_with_values(case, case.start, case.before, progress)
    if case.deadline.passed:
        return replace(plain, unfinished=(*plain.unfinished, Unfinished.OWN_VALUES))
    plain = plain.compared_by_log(case)
    result, tried = plain, list[frozenset[Place]]()
    while len(tried) < TOLERANCES.search.by_recording:
        wanted = places_of(result.differs)
        if not leading(result.differs):
            wanted |= differing_elsewhere(result.model, result.after, case.problem.catalogue)
            if wanted == places_of(result.differs):
                break
        if wanted in tried:
            break
        tried.append(wanted)
        start = with_values_by_log(case.start, wanted, case.problem.catalogue)
        result = _search_with_values(case, start, fit(start), progress)
        if result.unfinished or case.deadline.passed:
            return replace(plain, unfinished=(Unfinished.OWN_VALUES,))
        result = result.compared_by_log(case)
        if places_of(result.differs) == wanted:
            better = explains_more(result.model, plain.model) and not worse_elsewhere(
                result.model, result.after, plain.after, wanted
            )
            return result if better else plain
    return plain


def _search_with_values(
    case: SplitProblem, model: Prepared, before: Identification, progress: Progress
) -> SearchResult:
    """Search from a model with this model's effects, or some of them; the others are identified again.

    before: the answer of `model`.
    """
    given = [instance.name for instance in model.effects]
    barred = not_asked(case.problem.dataset.recordings, case.problem.catalogue, given)
    for start in origins_of(model):
        base_model = base_model_of(start, case.deadline)
        # without a name, which would keep the first system until the end
        finding = search_from(
            case, base_model, first_round(base_model, case.problem.catalogue, progress), progress, barred
        )
        samples = finding.last.system.samples
        if start is model or finding.weight_by(samples) >= answer_weight(samples, model, before):
            break
    return finding
