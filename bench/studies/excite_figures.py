"""The benefit of `bench excite` by robot: `python -m bench.studies.excite_figures -o results/excite`.

Designed motions are compared with the median of 50 random ones with the same limits and duration, and predicted
standard errors with the spread over repeated simulations.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click
import numpy as np
from scipy.stats import chi2

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically, write_text_atomically
from bench.basics.sentence import in_percent
from bench.basics.versions import versions
from bench.dataset.dataset import Dataset
from bench.dataset.robot import load_robot
from bench.document.markdown.tables import rows_in_markdown
from bench.excitation.bounds import SEARCH
from bench.excitation.experiment.forecast import Forecast, described, forecast
from bench.excitation.experiment.plan import Aim, ExperimentPlan, plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.identification.identify import identify
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import problem_of
from bench.identification.standstill import interpolated
from bench.scenario.scenario import Scenario, load_scenario
from bench.signals.decimation import decimate
from bench.signals.processing import trim
from bench.signals.settings import choose_settings, signal_bands
from bench.studies.rehearsal import scenario_of
from bench.truth.dataset import as_dataset
from bench.truth.resense import sense_again
from bench.truth.simulate import simulate

CONFIDENCE = 0.95
PAGE = "excite.md"
TRUE = ("robot", "repetitions", "unknowns", "on the whole", "smallest", "largest", "by chance alone")
PLANNED = """\
Motions of 10 s by `bench excite`, one unloaded and one with the payload of the robot's scenario, and 50 random motions
inside the same limits. The worst of all unknowns counts."""
REPEATED = """\
Below, the simulated machine runs the planned motions repeatedly, with different noise in each log. Each log
is identified. The ratio of the standard deviation of the estimates to the predicted standard error is 1 if the
prediction is right."""
INTERVALS = """\
so many repetitions cannot determine a standard deviation more precisely. Those of the smallest and the largest
ratio hold for all unknowns at once (Bonferroni), because these two were selected from all. "By chance alone": the
range of all ratios, with at least that probability, if every prediction is exact. "On the whole" is the root mean
square over the unknowns; its interval takes account of their correlations."""
ROBOTS = ("two_link", "five_bar", "delta", "stewart")
DURATION = 10.0  # s


def with_other_currents(prepared: Prepared, dataset: Dataset) -> Prepared | None:
    """The result of `prepare` for a dataset whose recordings are all fitted, from that of another one with the same
    positions.

    None if the result would differ in more than the currents: other positions, recordings or filters, effects,
    redundant motors.
    """
    before = [measured.recording for measured in prepared.measured]
    recordings = dataset.recordings
    if prepared.effects or dataset.robot.redundant or len(recordings) != len(before):
        return None
    for recording, known in zip(recordings, before, strict=True):
        same = recording.use == known.use == "identify" and recording.payload == known.payload
        if not same or recording.extra or not np.array_equal(recording.position, known.position):
            return None
    positions = [recording.position for recording in recordings]
    currents = [recording.current for recording in recordings]
    bands = signal_bands(positions, currents, recordings[0].rate)
    settings = prepared.settings
    if choose_settings(positions, currents, recordings[0].rate, bands) != settings:
        return None
    measured = tuple(
        replace(entry, recording=recording, current=trim(recording.current, settings))
        for entry, recording in zip(prepared.measured, recordings, strict=True)
    )
    observations = tuple(
        replace(observation, current=decimate(interpolated(entry.current, entry.gaps), settings.decimation))
        for observation, entry in zip(prepared.observations, measured, strict=True)
    )
    return replace(
        prepared, dataset=dataset, measured=measured, observations=observations, bands=bands, kept={}
    )


@dataclass(frozen=True)
class ForecastTrial:
    """A forecast compared with repeated simulations.

    ratios: by unknown, the standard deviation of its estimates over all repetitions, over its predicted standard error,
    1 if the prediction is right; repetitions: number of logs; independent: effective number of independent unknowns,
    from the correlations of their estimates.
    """

    ratios: Mapping[str, float]
    repetitions: int
    independent: float

    @property
    def pooled(self) -> float:
        """The root mean square of all ratios; 1 if the forecast is right overall."""
        return float(np.sqrt(np.mean(np.square(list(self.ratios.values())))))

    @property
    def every_by_chance(self) -> tuple[float, float]:
        """Interval that contains every ratio over its true value in at least a share CONFIDENCE of such trials."""
        return by_chance(self.repetitions, at_once=len(self.ratios))


def by_chance(repetitions: int, *, independent: float = 1.0, at_once: int = 1) -> tuple[float, float]:
    """Interval of a sample standard deviation over the true one with probability CONFIDENCE, from chi-square.

    independent: number of pooled estimates; at_once: number that are in the interval simultaneously (Bonferroni).
    """
    freedom = (repetitions - 1) * independent
    outside = (1.0 - CONFIDENCE) / at_once
    low, high = np.sqrt(chi2.ppf([0.5 * outside, 1.0 - 0.5 * outside], freedom) / freedom)
    return float(low), float(high)


def monte_carlo(
    plan: ExperimentPlan, expectation: Forecast, repetitions: int, seed: int = 0
) -> ForecastTrial:
    """Simulate the planned motions once, log them `repetitions` times with different noise, and identify each log.

    Raises BenchError for fewer than two repetitions.
    """
    if repetitions < 2:
        raise BenchError(f"{repetitions} repetitions have no standard deviation: give at least 2")
    scenario = planned_scenario(plan, seed)
    simulation = simulate(scenario)
    estimates, prepared = [], None
    for repetition in range(repetitions):
        again = _seeded(scenario, seed + repetition)
        prepared = _prepared(as_dataset(sense_again(simulation, again)), plan, prepared)
        estimates.append(_estimate(prepared, plan))
    stds = {unknown.name: unknown.std for unknown in expectation.unknowns}
    known = {name: std for name, std in stds.items() if std is not None}
    shown = np.array(estimates)[:, [name in known for name in stds]]
    spreads = np.std(shown, axis=0, ddof=1).tolist()
    ratios = {name: spread / known[name] for name, spread in zip(known, spreads, strict=True)}
    return ForecastTrial(ratios, repetitions, _independent(shown))


def _independent(estimates: np.ndarray) -> float:
    """Effective number of independent estimates among the columns, for the degrees of freedom of their mean square
    (Satterthwaite).
    """
    correlations = np.atleast_2d(np.corrcoef(estimates, rowvar=False))
    return float(len(correlations) ** 2 / (correlations**2).sum())


def planned_scenario(plan: ExperimentPlan, seed: int) -> Scenario:
    """The experiment as a scenario, without the recordings for validation."""
    whole = scenario_of(plan)
    fitted = tuple(recording for recording in whole.settings.recordings if recording.use == "identify")
    return _seeded(replace(whole, settings=whole.settings.model_copy(update={"recordings": fitted})), seed)


def _seeded(scenario: Scenario, seed: int) -> Scenario:
    return replace(scenario, settings=scenario.settings.model_copy(update={"seed": seed}))


def _prepared(dataset: Dataset, plan: ExperimentPlan, before: Prepared | None) -> Prepared:
    """The equations of a log. before: those of another log of the same motions, or None."""
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


BETTER = (
    "robot",
    "worst relative standard error",
    "median of random motions",
    "best of them",
    "times better than the median",
    "commit",
)

Figures = Mapping[str, Any]


def kept_figures(folder: Path, robots: Sequence[str]) -> list[Figures]:
    """The figures of the robots with a file in the folder."""
    files = [folder / f"{robot}.json" for robot in robots]
    return [json.loads(file.read_text(encoding="utf-8")) for file in files if file.is_file()]


def page(robots: Sequence[Figures]) -> str:
    """Both tables as Markdown."""
    better, true = tables(robots)
    parts = (
        "# Planned motions, and whether predictions come true",
        PLANNED,
        better,
        REPEATED,
        true,
        f"In brackets {in_percent(CONFIDENCE, 2)} intervals by chi-square:\n{INTERVALS}",
        "`python -m bench.studies.excite_figures ROBOT --repetitions N -o results/excite` rewrites this page.",
    )
    return "\n\n".join(parts) + "\n"


def tables(robots: Sequence[Figures]) -> tuple[str, str]:
    """The motions and the repetitions as Markdown."""
    repeated = [_true(figures) for figures in robots if "pooled" in figures]
    return rows_in_markdown(BETTER, map(_better, robots)), rows_in_markdown(TRUE, repeated)


def _better(figures: Figures) -> Sequence[str]:
    errors = [in_percent(figures[name], 2) for name in ("worst", "random_median", "random_best")]
    return figures["robot"], *errors, f"{figures['better']:.1f}", figures["commit"]


def _true(figures: Figures) -> Sequence[str]:
    intervals = [
        f"{figures[name]:.2f} " + "[{:.2f}, {:.2f}]".format(*figures[f"{name}_interval"])
        for name in ("pooled", "smallest", "largest")
    ]
    chance = "{:.2f} to {:.2f}".format(*figures["chance"])
    return figures["robot"], str(figures["repetitions"]), str(len(figures["ratios"])), *intervals, chance


def table_of(robot: str) -> ExperimentTable:
    """The limits and the payload of the robot's built-in scenario."""
    settings = load_scenario(robot).settings
    design = settings.recordings[0].design
    if design is None:
        raise click.UsageError(f"scenario {robot} has no design to take limits from")
    payload = next(iter(settings.payloads.values()))
    return ExperimentTable.model_validate(
        {
            "duration": DURATION,
            "velocity": design.velocity_limit,
            "acceleration": design.acceleration_limit,
            "payload": payload.model_dump(exclude={"declared"}),
        }
    )


def figures_of(robot: str, steps: int, seed: int, repetitions: int) -> dict[str, Any]:
    """Figures of one robot: design, random motions, and (with repetitions) a comparison of the forecast with
    simulations.
    """
    plan = plan_experiment(load_robot(robot), table_of(robot), Aim(steps=steps, seed=seed))
    figures: dict[str, Any] = {
        "robot": robot,
        "seed": seed,
        "steps": steps,
        "duration": DURATION,
        "worst": plan.value,
        "random_median": plan.random["median"],
        "random_best": plan.random["best"],
        "better": plan.random["median"] / plan.value,
        **versions().columns(),
    }
    if repetitions:
        trial = monte_carlo(plan, forecast(plan), repetitions, seed)
        smallest, largest = min(trial.ratios.values()), max(trial.ratios.values())
        figures |= {
            "repetitions": repetitions,
            "pooled": trial.pooled,
            "pooled_interval": interval(trial.pooled, by_chance(repetitions, independent=trial.independent)),
            "smallest": smallest,
            "smallest_interval": interval(smallest, trial.every_by_chance),
            "largest": largest,
            "largest_interval": interval(largest, trial.every_by_chance),
            "chance": trial.every_by_chance,
            "ratios": trial.ratios,
        }
    return figures


def interval(value: float, chance: tuple[float, float]) -> tuple[float, float]:
    """Interval of the true value of an observed ratio; chance: the spread of the ratio by chance."""
    low, high = chance
    return value / high, value / low


@click.command()
@click.argument("robots", nargs=-1)
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="Folder of the figures.")
@click.option("--steps", type=int, default=SEARCH.steps, show_default=True, help="Of the search.")
@click.option("--seed", type=int, default=0, show_default=True)
@click.option("--repetitions", type=int, default=1000, show_default=True, help="Simulated logs; 0: none.")
def main(robots: tuple[str, ...], output: Path, steps: int, seed: int, repetitions: int) -> None:
    """Write the figures of the robots, one JSON file each, and a page of all that the folder has; print them."""
    for robot in robots or ROBOTS:
        figures = figures_of(robot, steps, seed, repetitions)
        write_json_atomically(output / f"{robot}.json", figures)
        click.echo("\n".join(tables([figures])))
    write_text_atomically(output / PAGE, page(kept_figures(output, ROBOTS)))


if __name__ == "__main__":
    main()
