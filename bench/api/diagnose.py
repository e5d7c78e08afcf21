"""Which physical effects a model lacks."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from bench.api.sources import Data, as_dataset
from bench.basics.deadline import deadline_in
from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.discovery.find import find_missing_effects
from bench.diagnosis.result import Diagnosis
from bench.identification.decision import DecisionRule, deciding_by
from bench.identification.findings import short_recordings
from bench.identification.problem import Filters, problem_of
from bench.identification.tolerances import Tolerances, bounded_by

TIME_LIMIT = 600.0
"""s: several times the duration of a search on a robot with six motors, and an acceptable wait for an answer."""


def diagnose(
    data: Data,
    effects: Sequence[str] = (),
    *,
    filters: Filters = None,
    effect_files: Iterable[str | Path] = (),
    discover: bool | None = None,
    progress: Progress = SILENT,
    time_limit: float | None = TIME_LIMIT,
    rule: DecisionRule | None = None,
    tolerances: Tolerances | None = None,
) -> Diagnosis:
    """Which physical effects the model lacks, judged on recordings that were not fitted.

    data: a dataset or its folder. effects: those already in the model, each as EFFECT or EFFECT:PLACE. filters:
    settings, or some of them by name; the others are chosen from the data. effect_files: Python files with user-defined
    effects, which compete along with those that the dataset names. discover: whether laws outside the catalogue compete
    too; by default, only if the catalogue leaves an error unexplained. progress: receives the state of the search.
    time_limit: s; after it the best answer so far is returned, which says what was not examined (`finished`,
    `unfinished`); None: no limit. rule, tolerances: thresholds and numerical bounds in place of the defaults.
    Raises BenchError naming what in dataset, robot or files cannot be used.
    """
    if time_limit is not None and not time_limit > 0.0:
        raise BenchError(f"time limit {time_limit:g}: give a positive number of seconds")
    deadline = deadline_in(time_limit)
    progress.phase("reading the recordings")
    dataset = as_dataset(data)
    with deciding_by(rule), bounded_by(tolerances):
        problem = problem_of(dataset, effects, filters, effect_files=effect_files)
        diagnosis = find_missing_effects(problem, discover=discover, progress=progress, deadline=deadline)
        after = diagnosis.after
        short = short_recordings(dataset.recordings, after.settings)
    return replace(diagnosis, after=replace(after, findings=(*after.findings, *short)))
