"""From recordings to drive gains and dynamic parameters."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from bench.api.sources import Data, as_dataset
from bench.diagnosis.mounting import mounted_otherwise
from bench.identification.chosen_band import prepare_checked
from bench.identification.decision import DecisionRule, deciding_by
from bench.identification.estimators import DEFAULT_METHOD
from bench.identification.finding import mended_first
from bench.identification.findings import short_recordings
from bench.identification.identify import identify as fitted
from bench.identification.mistaken import mistaken
from bench.identification.problem import Filters, problem_of
from bench.identification.result import Identification
from bench.identification.standard_errors import Deviations
from bench.identification.tolerances import Tolerances, bounded_by


def identify(  # noqa: PLR0913 - an argument for each choice
    data: Data,
    effects: Sequence[str] = (),
    method: str = DEFAULT_METHOD,
    *,
    filters: Filters = None,
    effect_files: Iterable[str | Path] = (),
    deviations: Deviations = "autocorrelated",
    fit_gains: bool | None = None,
    essential: bool = False,
    physical: bool = False,
    rule: DecisionRule | None = None,
    tolerances: Tolerances | None = None,
) -> Identification:
    """Identify drive gains and dynamic parameters together (Briot and Gautier 2012, equations 8 to 13).

    data: a dataset or its folder. effects: names as EFFECT, EFFECT:PLACE or with @recording, added to the rigid-body
    model. method: current, robust, iv, oe, ls, wls, tls or wtls. filters: settings, or some of them by name; the others
    are chosen from the spectra. effect_files: Python files with user-defined effects. deviations: how standard errors
    are computed. fit_gains: whether drive gains are unknowns; by default, those that the declared payloads fix are, and
    the others stay nominal. essential: omit base parameters that the data do not need. physical: only physically
    consistent parameters, those that real bodies can have (needs cvxpy). rule, tolerances: thresholds and numerical
    bounds in place of the defaults. The result's findings say what limits it.
    Raises BenchError naming what in the data or the robot cannot be used.
    """
    dataset = as_dataset(data)
    with deciding_by(rule), bounded_by(tolerances):
        problem = problem_of(dataset, effects, filters, effect_files=effect_files, fit_gains=fit_gains)
        prepared = prepare_checked(problem)
        result = fitted(prepared, method, deviations=deviations, essential=essential)
        causes = mistaken(problem, result, prepared)
        mounted = mounted_otherwise(prepared)
        short = short_recordings(dataset.recordings, result.settings)
        annotated = replace(result, findings=mended_first((*causes, *mounted, *result.findings, *short)))
        if not physical:
            return annotated
        from bench.export.physical import physically_consistent  # noqa: PLC0415 - slow, and for this alone

        return physically_consistent(annotated, problem)
