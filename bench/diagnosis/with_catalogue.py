"""A diagnosis with the effects of the catalogue, without laws."""

from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.diagnosis.answer import answered
from bench.diagnosis.catalogue_search import search_catalogue
from bench.diagnosis.completed import completed
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.split_problem import split_and_fitted
from bench.identification.problem import Problem


@on_one_thread
def diagnose_with_catalogue(problem: Problem, progress: Progress = SILENT) -> Diagnosis:
    """Compare a model with the data, and identify the effects of the catalogue that it lacks, without laws.

    Evidence is a likelihood ratio on recordings that were not fitted (or, if there are none, on the last part of each),
    with the number of independent samples. All sets of up to three effects compete; each must earn its place.
    """
    case = split_and_fitted(problem, progress)
    finding = search_catalogue(case, progress)
    return completed(finding, answered(case, finding, progress))
