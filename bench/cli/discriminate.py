"""`bench discriminate`: design the motion that distinguishes two effects."""

from pathlib import Path

import click

from bench.cli.last_lines import say, wrote
from bench.cli.options import (
    Asked,
    dataset_argument,
    effect_file_option,
    filter_options,
    output_option,
    with_option,
)
from bench.cli.options import effects as effect_names
from bench.cli.progress import quiet_option, shown_progress

POSITIVE = click.FloatRange(min=0.0, min_open=True)


WIDEN, RATE = 1.0, 1000.0


@click.command("discriminate")
@dataset_argument
@click.argument("effect_a", metavar="EFFECT_A", shell_complete=effect_names)
@click.argument("effect_b", metavar="EFFECT_B", shell_complete=effect_names)
@output_option(
    "Folder for the trajectory, its coefficients, a summary and a picture.", required=True, callback=None
)
@with_option
@effect_file_option
@click.option(
    "--duration", type=POSITIVE, metavar="S", help="Length of the motion. [default: as the longest recording]"
)
@click.option(
    "--widen",
    type=POSITIVE,
    default=WIDEN,
    show_default=True,
    metavar="FACTOR",
    help="Largest speeds, accelerations and currents, as a multiple of the recorded ones.",
)
@click.option(
    "--rate",
    type=POSITIVE,
    default=RATE,
    show_default=True,
    metavar="HZ",
    help="Rows per second in the table.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of the search.")
@filter_options
@quiet_option
def discriminate(  # noqa: PLR0913, PLR0917 - an argument for each option
    dataset: Path,
    effect_a: str,
    effect_b: str,
    output: Path,
    duration: float | None,
    widen: float,
    rate: float,
    seed: int,
    quiet: bool,
    asked: Asked,
) -> None:
    """Design the motion that distinguishes two effects.

    If DATASET cannot distinguish EFFECT_A from EFFECT_B, each as EFFECT or EFFECT:JOINT, another motion may. This
    command searches for the motion on which the two models differ most, inside the robot's joint ranges and the
    speeds, accelerations and currents of the recordings, and writes it for a controller. If no motion of the
    robot can distinguish them, it says so.
    """
    with shown_progress(quiet) as progress:
        from bench.basics.program import typed
        from bench.basics.shell_word import quoted
        from bench.dataset.catalogue import built_in_robots
        from bench.dataset.dataset import load_dataset
        from bench.excitation.discrimination.discriminate import discriminate as run
        from bench.excitation.discrimination.figure import write_discrimination_figure
        from bench.excitation.discrimination.files import (
            ANSWER,
            CommandLines,
            check_folder,
            write_discrimination,
        )

        check_folder(output, ANSWER)
        progress.phase("reading the recordings")
        data = load_dataset(dataset)
        run_diagnosis = asked.run("diagnose", dataset)
        answer = run(
            asked.of(data),
            (effect_a, effect_b),
            duration=duration,
            widen=widen,
            seed=seed,
            progress=progress,
        )
        progress.phase("writing the motion and its picture")
        motion = {"duration": duration, "widen": None if widen == WIDEN else widen}
        motion |= {"rate": None if rate == RATE else rate, "seed": seed or None}
        run_of = asked.run("discriminate", dataset, {**asked.filters, **motion}, output)
        words = ["bench", "discriminate", str(dataset), effect_a, effect_b, *run_of.option_words()]
        robot_folder = data.robot.folder.resolve()
        built_in = [name for name, folder in built_in_robots().items() if folder.resolve() == robot_folder]
        robot = quoted(built_in[0] if built_in else robot_folder)
        context = CommandLines(" ".join(map(quoted, words)), run_diagnosis.line(), quoted(dataset), robot)
        paths = write_discrimination(output, answer, write_discrimination_figure, rate=rate, commands=context)
    from rich.console import Console
    from rich.text import Text

    from bench.excitation.discrimination.sentences import next_step, sentences, warnings

    console = Console()
    doubts = warnings(answer)
    for sentence in sentences(answer):
        console.print(Text(sentence, "yellow" if sentence in doubts else ""))
    for path in paths:
        say([wrote(path)])
    step = next_step(answer, run_diagnosis.line(typed()), output)
    if step is not None:
        click.echo(step)
