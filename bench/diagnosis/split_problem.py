"""A problem to diagnose, in parts to fit and to judge on, with the fit of its starting model."""

from dataclasses import dataclass, replace

from bench.basics.deadline import NEVER, Deadline
from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.extrapolated import without_extrapolation
from bench.diagnosis.split import with_held_out_parts
from bench.identification.chosen_band import prepare_checked
from bench.identification.finding import Finding
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.result import Identification


@dataclass(frozen=True)
class SplitProblem:
    """A problem to diagnose: in parts to fit and to judge on, its starting model, and that model's fit.

    deadline: after it the best answer so far is returned. extrapolated: rows that are not judged.
    """

    problem: Problem
    held_out: float
    start: Prepared
    before: Identification
    deadline: Deadline = NEVER
    extrapolated: tuple[Finding, ...] = ()


def split_and_fitted(
    problem: Problem, progress: Progress = SILENT, deadline: Deadline = NEVER
) -> SplitProblem:
    """Hold out parts to judge on, prepare the problem and fit the starting model, without a deadline."""
    progress.phase("preparing the recordings")
    dataset, held_out = with_held_out_parts(problem.dataset)
    problem = replace(problem, dataset=dataset)
    start = prepare_checked(problem)
    judged = [seen for seen in start.observations if seen.use == "validate"]
    if judged and not any(seen.moving.any() for seen in judged):
        names = " and ".join(seen.name for seen in judged)
        raise BenchError(
            f"{dataset.folder}: no joint moves in {names}, on which effects are judged: record a motion with "
            'use = "validate", or leave it out'
        )
    progress.phase("fitting the model as it is")
    start, extrapolated = without_extrapolation(converged(start))
    return SplitProblem(problem, held_out, start, fit(start), deadline, extrapolated)
