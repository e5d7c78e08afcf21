"""What `bench excite` is worth, robot by robot: `python -m bench.studies.excite_figures -o results/excite`.

Designed motions beside the median of 50 random ones inside the same limits and time; forecast standard errors beside
the spread of repeated simulations.
"""

from pathlib import Path
from typing import Any

import click

from bench.basics.files.atomic import write_json_atomically
from bench.dataset.robot import load_robot
from bench.excitation.experiment.forecast import forecast
from bench.excitation.experiment.plan import STEPS, Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.excitation.experiment.search import RANDOM
from bench.scenario.scenario import load_scenario
from bench.studies.excite_forecast import monte_carlo, pooled

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
    }
    if repetitions:
        outcomes = monte_carlo(plan, forecast(plan), repetitions, seed)
        ratios = [outcome.ratio for outcome in outcomes]
        figures |= {
            "repetitions": repetitions,
            "pooled": pooled(outcomes),
            "smallest": min(ratios),
            "largest": max(ratios),
        }
    return figures


def figures_json(path: Path, figures: dict[str, Any]) -> None:
    """Write the figures of one robot."""
    write_json_atomically(path / f"{figures['robot']}.json", figures)


def sentence(figures: dict[str, Any]) -> str:
    """One robot in one line."""
    text = (
        f"{figures['robot']}: worst relative error {figures['worst']:.3%}, {figures['better']:.2f} times better than "
        f"the median of {RANDOM} random motions ({figures['random_median']:.3%}; best {figures['random_best']:.3%})"
    )
    if "pooled" in figures:
        text += (
            f"; spread over {figures['repetitions']} repetitions / forecast: {figures['pooled']:.2f} on the whole, "
            f"{figures['smallest']:.2f} to {figures['largest']:.2f}"
        )
    return text


@click.command()
@click.argument("robots", nargs=-1)
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="Folder of the figures.")
@click.option("--steps", type=int, default=STEPS, show_default=True, help="Of the search.")
@click.option("--seed", type=int, default=0, show_default=True)
@click.option("--repetitions", type=int, default=120, show_default=True, help="Simulated logs; 0: none.")
def main(robots: tuple[str, ...], output: Path, steps: int, seed: int, repetitions: int) -> None:
    """Write the figures of the robots, one JSON file each, and print them."""
    for robot in robots or ROBOTS:
        figures = figures_of(robot, steps, seed, repetitions)
        figures_json(output, figures)
        click.echo(sentence(figures))


if __name__ == "__main__":
    main()
