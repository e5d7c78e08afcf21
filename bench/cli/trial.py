"""`bench trial`: the reliability of a diagnosis of a robot."""

from pathlib import Path
from typing import Any

import click

from bench.cli.last_lines import say, wrote
from bench.cli.options import output_option, robots, scheduler_option, workers_option
from bench.cli.progress import quiet_option, shown_progress


@click.command("trial")
@click.argument("robot", metavar="ROBOT", shell_complete=robots)
@click.option("--effects", metavar="A,B,...", default="", help="Hide only these. [default: all]")
@click.option(
    "--kinds",
    metavar="A,B,...",
    default="",
    help="From nothing, one, two, three (hidden effects), outside (an effect that no model contains), unknown (a "
    "random law). [default: all]",
)
@click.option(
    "--seeds",
    type=click.IntRange(1, 10_000),
    default=3,
    show_default=True,
    help="Datasets per effect of `one` and `outside`; ten times as many of each other kind.",
)
@click.option(
    "--first",
    type=click.IntRange(0),
    default=0,
    metavar="N",
    help="Number of the first dataset of every kind, for a set that shares none with another. [default: 0]",
)
@click.option("--discover", is_flag=True, help="Search for laws in every dataset, even if no error remains.")
@click.option(
    "--scenario", metavar="NAME", help="Motions, sensors and payload. [default: those of the robot]"
)
@click.option(
    "--duration", type=click.FloatRange(2.0), metavar="S", help="Duration of each designed motion, s."
)
@output_option("Folder of the results.", default=Path("trial"), show_default=True)
@workers_option
@scheduler_option
@quiet_option
def trial(
    robot: str,
    effects: str,
    kinds: str,
    seeds: int,
    first: int,
    discover: bool,
    scenario: str | None,
    duration: float | None,
    output: Path,
    **running: Any,
) -> int:
    """Diagnose simulated machines whose hidden effects are known.

    ROBOT is a built-in name or a robot folder. Datasets are drawn from seeds; each is diagnosed without access
    to the truth. Finished ones are kept in DIR: if the trial is interrupted and started again, or started with
    more seeds, it resumes. The answer does not depend on the number of workers.
    """
    with shown_progress(running["quiet"]):
        from bench.studies.sweep.pool import Workers
        from bench.studies.trial.command import Drawn, run_command

    code = run_command(
        robot,
        output,
        Drawn(_listed(effects), _listed(kinds), seeds, first, discover),
        scenario=scenario,
        duration=duration,
        workers=Workers(running["workers"], running["scheduler"]),
        quiet=running["quiet"],
    )
    with shown_progress(running["quiet"], "drawing the page"):
        from bench.dataset.robot import load_robot
        from bench.page.section_run import CommandRun
        from bench.page.write_studies import write_trial_report

        table = output / f"{load_robot(robot).name}.parquet"
        pages = [write_trial_report(table, table.with_suffix(".html"))] if table.is_file() else []
    given: dict[str, Any] = {"effects": effects or None, "kinds": kinds or None, "first": first or None}
    given |= {"discover": discover, "scenario": scenario}
    given |= {"duration": duration and f"{duration:g}", "seeds": 2 * seeds}
    run = CommandRun("trial", robot, options=given, output=str(output))
    again = f"next: {run.line()}    adds as many datasets again"
    say([*(wrote(page, "report") for page in pages), again])
    return code


def _listed(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())
