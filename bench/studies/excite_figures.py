"""What `bench excite` is worth, robot by robot: `python -m bench.studies.excite_figures -o results/excite`.

Designed motions compared with the median of 50 random ones inside the same limits and time; forecast standard errors
with the spread of repeated simulations.
"""

from pathlib import Path
from typing import Any

import click

from bench.basics.files.atomic import write_json_atomically
from bench.basics.versions import versions
from bench.dataset.robot import load_robot
from bench.excitation.bounds import SEARCH
from bench.excitation.experiment.forecast import forecast
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.identification.wording import in_percent
from bench.scenario.scenario import load_scenario
from bench.studies.excite_forecast import CONFIDENCE, monte_carlo
from bench.studies.excite_page import with_interval, write_page

ROBOTS = ("two_link", "five_bar", "delta", "stewart")
DURATION = 10.0  # s


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
    """One robot: design, random motions, and (with repetitions) how the forecast came true."""
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
        ratios = {outcome.name: outcome.ratio for outcome in trial.outcomes}
        figures |= {
            "repetitions": repetitions,
            "pooled": trial.pooled,
            "pooled_interval": interval(trial.pooled, trial.pooled_by_chance),
            "smallest": min(ratios.values()),
            "smallest_interval": interval(min(ratios.values()), trial.every_by_chance),
            "largest": max(ratios.values()),
            "largest_interval": interval(max(ratios.values()), trial.every_by_chance),
            "chance": trial.every_by_chance,
            "ratios": ratios,
        }
    return figures


def interval(value: float, chance: tuple[float, float]) -> tuple[float, float]:
    """Interval of the true value of an observed ratio; chance: the spread of the ratio by chance."""
    low, high = chance
    return value / high, value / low


def figures_json(path: Path, figures: dict[str, Any]) -> None:
    """Write the figures of one robot."""
    write_json_atomically(path / f"{figures['robot']}.json", figures)


def sentence(figures: dict[str, Any]) -> str:
    """One robot in one line."""
    text = (
        f"{figures['robot']}: worst relative error {figures['worst']:.3%}, {figures['better']:.2f} times better than "
        f"the median of {SEARCH.random} random motions ({figures['random_median']:.3%}; "
        f"best {figures['random_best']:.3%})"
    )
    if "pooled" in figures:
        pooled, smallest, largest = (
            with_interval(figures, name) for name in ("pooled", "smallest", "largest")
        )
        text += (
            f"; spread over {figures['repetitions']} repetitions / forecast: {pooled} on the whole, {smallest} to "
            f"{largest}; in brackets {in_percent(CONFIDENCE, 2)} intervals, of the extremes for all "
            f"{len(figures['ratios'])} unknowns at once"
        )
    return text


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
        figures_json(output, figures)
        click.echo(sentence(figures))
    write_page(output, ROBOTS)


if __name__ == "__main__":
    main()
