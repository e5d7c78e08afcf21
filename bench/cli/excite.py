"""`bench excite`: plan an experiment before there are any data."""

from pathlib import Path
from typing import Any

import click

from bench.cli.last_lines import next_line, say, wrote
from bench.cli.options import (
    effect_file_option,
    in_existing_folder,
    output_option,
    path_option,
    positive,
    rate,
    with_option,
)
from bench.cli.options import effects as effect_names
from bench.cli.options import robots as robot_names
from bench.cli.progress import quiet_option, shown_progress


def _share(text: str) -> float:
    """The type of a share such as 0.5% or 0.005."""
    try:
        share = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        share = -1.0
    if not 0.0 < share < 1.0:
        raise click.BadParameter(f"{text!r} is not a share; write for example 0.5%")
    return share


@click.command("excite")
@click.argument("robot", shell_complete=robot_names)
@output_option(
    "Folder for tables, coefficients, a scenario, pictures and the forecast.", required=True, callback=None
)
@click.option(
    "--for",
    "wanted",
    multiple=True,
    shell_complete=effect_names,
    metavar="WHAT",
    help="all, gains, parameters, or an effect as EFFECT or EFFECT:JOINT. Repeat for each.  [default: all]",
)
@path_option(
    "--limits",
    "limits",
    metavar="FILE",
    callback=in_existing_folder,
    help="TOML with limits by joint, workspace boxes, payload and sensors.",
)
@click.option(
    "--velocity",
    type=rate("s"),
    multiple=True,
    metavar="V",
    help="Largest speed of every joint, or of hinges and slides apart: 3rad/s and 0.5m/s. Repeat for each.",
)
@click.option(
    "--acceleration",
    type=rate("s2"),
    multiple=True,
    metavar="A",
    help="Largest acceleration, likewise: 30rad/s2, 5m/s2.",
)
@click.option("--current", type=positive, metavar="I", help="Largest current, drive unit.")
@click.option("--duration", type=positive, metavar="S", help="Duration of each motion.  [default: 20]")
@click.option(
    "--payload-mass", type=positive, metavar="KG", help="Weighed mass; the centre is then estimated."
)
@click.option(
    "--gain-accuracy",
    type=_share,
    metavar="SHARE",
    help="Print the payload and time that suffice, e.g. 0.5%.",
)
@path_option("--after", metavar="DATASET", help="Plan the one motion that adds most to these recordings.")
@with_option
@effect_file_option
@click.option(
    "--criterion",
    type=click.Choice(["worst", "d-optimal"]),
    default="worst",
    show_default=True,
    help="Worst relative standard error, or volume of the error ellipsoid.",
)
@click.option(
    "--steps", type=click.IntRange(0), default=90, show_default=True, help="Linear programs of the search."
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of the search.")
@quiet_option
def excite(
    robot: str,
    output: Path,
    wanted: tuple[str, ...],
    limits: Path | None,
    gain_accuracy: float | None,
    after: Path | None,
    effects: tuple[str, ...],
    effect_files: tuple[Path, ...],
    quiet: bool,
    **options: Any,
) -> None:
    """Plan motions to identify a robot, and predict their accuracy.

    The motions start and end at rest at home, with and without a payload, and keep all limits: joint ranges, speeds,
    accelerations, currents by nominal gains and the masses of the MJCF, workspace boxes, distance from singular poses.
    The command predicts the standard errors before a motor turns.
    """
    search = {name: options.pop(name) for name in ("criterion", "steps", "seed")}
    from bench.studies.pooled import PooledMapper

    with shown_progress(quiet) as progress, PooledMapper() as mapper:
        from bench.basics.errors import BenchError
        from bench.basics.quiet import stop_step_timers
        from bench.dataset.dataset import load_dataset
        from bench.dataset.robot import load_robot
        from bench.effects import catalogue_for
        from bench.excitation.discrimination.files import check_folder
        from bench.excitation.experiment.after import plan_after
        from bench.excitation.experiment.figure import write_plan_figure
        from bench.excitation.experiment.files import MARKS, PICTURE, SCENARIO, VIEW, write_plan
        from bench.excitation.experiment.forecast import forecast
        from bench.excitation.experiment.plan import WHOLE, Aim, ExperimentPlan, plan_experiment
        from bench.excitation.experiment.request import asked_table
        from bench.excitation.experiment.sentences import sentences
        from bench.identification.problem import problem_of
        from bench.studies.rehearsal import rehearsal_sentence, rehearse
        from bench.viewer.planned import write_planned_rrd

        check_folder(output, *MARKS)
        stop_step_timers()
        aim = Aim(wanted or WHOLE.wanted, **search)
        described = load_robot(robot)
        table = asked_table(limits, options, described)
        if after is None:
            catalogue = catalogue_for(effect_files)
            plan = plan_experiment(
                described, table, aim, effects, catalogue=catalogue, mapper=mapper, progress=progress
            )
        else:
            data = load_dataset(after)
            if data.robot.folder != described.folder:
                raise BenchError(
                    f"--after {after}: the dataset's robot is {data.robot.name!r}, not {robot!r}"
                )
            if gain_accuracy is not None:
                raise BenchError("--gain-accuracy: omit it with --after, where the payloads are given")
            problem = problem_of(data, effects, effect_files=effect_files)
            plan = plan_after(problem, table, aim, mapper=mapper, progress=progress)
        progress.phase("predicting the standard errors")
        prediction = forecast(plan, gain_accuracy)
        rehearsal = rehearse(plan, progress=progress)
        progress.phase("writing the motions")

        def view(path: Path, plan: ExperimentPlan) -> None:
            motions = {recording.name: recording.trajectory for recording in plan.recordings}
            write_planned_rrd(path, plan.robot, motions)

        write_plan(output, plan, prediction, {PICTURE: write_plan_figure, VIEW: view}, rehearsal.drive)
    for sentence in [*sentences(plan, prediction), rehearsal_sentence(rehearsal)]:
        if sentence:
            click.echo(sentence)
    say([wrote(output, "tables, coefficients, scenario, pictures, forecast")])
    if rehearsal.runs:
        folder = output.with_name(f"{output.resolve().name}.data")
        say([next_line(["simulate", output / SCENARIO, "-o", folder], "tries it in simulation")])
