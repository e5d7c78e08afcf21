"""Do forecasts of `bench excite` come true? The planned motions on the simulated machine, with noise ever anew."""

import tomllib
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.dataset.dataset import Dataset
from bench.excitation.experiment.files import scenario_text
from bench.excitation.experiment.forecast import Forecast, described
from bench.excitation.experiment.plan import ExperimentPlan
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import Scenario, scenario_from_dict
from bench.truth.dataset import as_dataset
from bench.truth.resense import sense_again
from bench.truth.simulate import simulate


@dataclass(frozen=True)
class ForecastOutcome:
    """One unknown: its forecast standard error, and the standard deviation of its estimates over all repetitions."""

    name: str
    expected: float
    found: float

    @property
    def ratio(self) -> float:
        """Found over expected: 1 where the forecast came true."""
        return self.found / self.expected


def monte_carlo(
    plan: ExperimentPlan, expectation: Forecast, repetitions: int, seed: int = 0, progress: Progress = SILENT
) -> tuple[ForecastOutcome, ...]:
    """Simulate the planned motions once, log them `repetitions` times with other noise, identify each.

    Raises BenchError for fewer than two repetitions.
    """
    if repetitions < 2:
        raise BenchError(f"{repetitions} repetitions have no standard deviation: give at least 2")
    progress.phase("simulating the motions")
    scenario = planned_scenario(plan, seed)
    simulation = simulate(scenario, progress=progress)
    progress.phase("identifying", repetitions)
    estimates = []
    for repetition in range(repetitions):
        progress.advance()
        again = _seeded(scenario, seed + repetition)
        estimates.append(_estimate(as_dataset(sense_again(simulation, again)), plan))
    spreads = np.std(estimates, axis=0, ddof=1)
    return tuple(
        ForecastOutcome(expected.name, expected.std, float(spread))
        for expected, spread in zip(expectation.unknowns, spreads, strict=True)
        if expected.std is not None
    )


def pooled(outcomes: tuple[ForecastOutcome, ...]) -> float:
    """The root mean square of all ratios: 1 where the forecast is right on the whole."""
    return float(np.sqrt(np.mean([outcome.ratio**2 for outcome in outcomes])))


def planned_scenario(plan: ExperimentPlan, seed: int) -> Scenario:
    """The experiment as a scenario, without the recordings that only check."""
    content = tomllib.loads(scenario_text(plan))
    content["seed"] = seed
    content["recordings"] = [entry for entry in content["recordings"] if entry["use"] == "identify"]
    for recording, motion in zip(content["recordings"], plan.motions, strict=True):
        del recording["trajectory_file"]
        recording["trajectory"] = motion.trajectory.to_dict()
    return scenario_from_dict(content, f"{plan.robot.name}_planned", robot=plan.robot)


def _seeded(scenario: Scenario, seed: int) -> Scenario:
    return replace(scenario, settings=scenario.settings.model_copy(update={"seed": seed}))


def _estimate(dataset: Dataset, plan: ExperimentPlan) -> np.ndarray:
    """The estimates in the order of the forecast."""
    result = identify(
        prepare(
            problem_of(dataset, list(dict.fromkeys(instance.request for instance in plan.nominal.effects)))
        )
    )
    values = {parameter.name: parameter.value for parameter in result.parameters}
    values |= {joint: gain.value for joint, gain in result.drive_gains.items()}
    for effect, places in result.effect_parameters.items():
        for place, parameters in places.items():
            values |= {f"{effect}:{place}.{name}": quantity.value for name, quantity in parameters.items()}
    return np.array([values[expected.name] for expected in described(plan.nominal)])
