"""Do forecasts of `bench excite` come true? The planned motions on the simulated machine, with noise ever anew."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.dataset.dataset import Dataset
from bench.excitation.experiment.forecast import Forecast, described
from bench.excitation.experiment.plan import ExperimentPlan
from bench.identification.identify import identify
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import Scenario
from bench.studies.logged_again import with_other_currents
from bench.studies.rehearsal import scenario_of
from bench.truth.dataset import as_dataset
from bench.truth.resense import sense_again
from bench.truth.simulate import simulate

CONFIDENCE = 0.95


@dataclass(frozen=True)
class ForecastOutcome:
    """One unknown: its forecast standard error, and the standard deviation of its estimates over all repetitions."""

    name: str
    expected: float
    observed: float

    @property
    def ratio(self) -> float:
        """Observed over expected: 1 where the forecast came true."""
        return self.observed / self.expected


@dataclass(frozen=True)
class ForecastTrial:
    """A forecast compared with repeated simulations. outcomes: of all unknowns that it says are determined;
    repetitions: of the logs; independent: how many of the unknowns count as independent, by the correlations of their
    estimates.
    """

    outcomes: tuple[ForecastOutcome, ...]
    repetitions: int
    independent: float

    @property
    def pooled(self) -> float:
        """The root mean square of all ratios: 1 where the forecast is right on the whole."""
        return float(np.sqrt(np.mean([outcome.ratio**2 for outcome in self.outcomes])))

    @property
    def pooled_by_chance(self) -> tuple[float, float]:
        """Between which a share CONFIDENCE of such trials has `pooled` over its true value."""
        return by_chance(self.repetitions, independent=self.independent)

    @property
    def every_by_chance(self) -> tuple[float, float]:
        """Between which a share CONFIDENCE of such trials, at least, has every ratio over its true value."""
        return by_chance(self.repetitions, at_once=len(self.outcomes))


def by_chance(repetitions: int, *, independent: float = 1.0, at_once: int = 1) -> tuple[float, float]:
    """How far chance takes a standard deviation, over the true one, with probability CONFIDENCE: chi-square.

    independent: how many estimates of it are pooled; at_once: how many keep to it together (Bonferroni).
    """
    freedom = (repetitions - 1) * independent
    outside = (1.0 - CONFIDENCE) / at_once
    low, high = np.sqrt(chi2.ppf([0.5 * outside, 1.0 - 0.5 * outside], freedom) / freedom)
    return float(low), float(high)


def monte_carlo(
    plan: ExperimentPlan, expectation: Forecast, repetitions: int, seed: int = 0, progress: Progress = SILENT
) -> ForecastTrial:
    """Simulate the planned motions once, log them `repetitions` times with other noise, identify each.

    Raises BenchError for fewer than two repetitions.
    """
    if repetitions < 2:
        raise BenchError(f"{repetitions} repetitions have no standard deviation: give at least 2")
    progress.phase("simulating the motions")
    scenario = planned_scenario(plan, seed)
    simulation = simulate(scenario, progress=progress)
    progress.phase("identifying", repetitions)
    estimates, prepared = [], None
    for repetition in range(repetitions):
        progress.advance()
        again = _seeded(scenario, seed + repetition)
        prepared = _prepared(as_dataset(sense_again(simulation, again)), plan, prepared)
        estimates.append(_estimate(prepared, plan))
    kept = np.array([expected.std is not None for expected in expectation.unknowns])
    shown = np.array(estimates)[:, kept]
    spreads = iter(np.std(shown, axis=0, ddof=1).tolist())
    outcomes = tuple(
        ForecastOutcome(expected.name, expected.std, next(spreads))
        for expected in expectation.unknowns
        if expected.std is not None
    )
    return ForecastTrial(outcomes, repetitions, _independent(shown))


def _independent(estimates: np.ndarray) -> float:
    """Of how many independent estimates the mean square of those in the columns has the freedom (Satterthwaite)."""
    correlations = np.atleast_2d(np.corrcoef(estimates, rowvar=False))
    return float(len(correlations) ** 2 / (correlations**2).sum())


def planned_scenario(plan: ExperimentPlan, seed: int) -> Scenario:
    """The experiment as a scenario, without the recordings that only check."""
    whole = scenario_of(plan)
    fitted = tuple(recording for recording in whole.settings.recordings if recording.use == "identify")
    return _seeded(replace(whole, settings=whole.settings.model_copy(update={"recordings": fitted})), seed)


def _seeded(scenario: Scenario, seed: int) -> Scenario:
    return replace(scenario, settings=scenario.settings.model_copy(update={"seed": seed}))


def _prepared(dataset: Dataset, plan: ExperimentPlan, before: Prepared | None) -> Prepared:
    """The equations of a log; before: of another one of the same motions, where there is one."""
    known = None if before is None else with_other_currents(before, dataset)
    if known is not None:
        return known
    requests = dict.fromkeys(instance.request for instance in plan.nominal.effects)
    return prepare(problem_of(dataset, list(requests)))


def _estimate(prepared: Prepared, plan: ExperimentPlan) -> np.ndarray:
    """The estimates in the order of the forecast."""
    result = identify(prepared)
    values = {parameter.name: parameter.value for parameter in result.parameters}
    values |= {joint: gain.value for joint, gain in result.drive_gains.items()}
    for effect, places in result.effect_parameters.items():
        for place, parameters in places.items():
            values |= {f"{effect}:{place}.{name}": quantity.value for name, quantity in parameters.items()}
    return np.array([values[expected.name] for expected in described(plan.nominal)])
