"""The command `bench`.

Each command is in a separate file and is imported on demand; `bench --help` reads the table below and imports none of
them. To add a command, write `bench/cli/NAME.py` with a click command, and add a line to `COMMANDS` with the first
sentence of its docstring as its help.
"""

import os
import warnings
from collections.abc import Sequence

import click

from bench.basics.errors import BenchError, lines_of
from bench.basics.program import called_as
from bench.cli.lazy import LazyCommand, LazyGroup, forgiving_output, misspelt
from bench.cli.termination import TERMINATED, leaving_on_termination

COMMANDS = {
    name: LazyCommand(f"bench.cli.{target}", text, section)
    for section, commands in {
        "Your measurements": (
            ("open", "open:open_page", "Go from logs to the named effect on a page in the browser."),
            ("import", "import_log:import_log", "Turn a controller's logs into a dataset."),
            ("robot", "robot:robot", "Make and check a robot folder: joints, loops, home pose."),
            ("identify", "identify:identify", "Identify drive gains and dynamic parameters from a dataset."),
            (
                "compare",
                "compare:compare",
                "Describe and plot where a model fails on a dataset's recordings.",
            ),
            ("diagnose", "diagnose:diagnose", "Name the physical effects that a model lacks, with evidence."),
            (
                "discriminate",
                "discriminate:discriminate",
                "Design the motion that distinguishes two effects.",
            ),
            ("excite", "excite:excite", "Plan motions to identify a robot, and predict their accuracy."),
        ),
        "View and export results": (
            ("report", "report:report", "Write a one-file page with the results of a run."),
            ("view", "view:view", "Show the moving robot, currents and errors in the Rerun viewer."),
            ("figures", "figures:figures", "Draw figures for papers, with their numbers as CSV."),
            ("export", "export:export", "Write an identified model as MJCF, URDF, a table or C."),
            ("replay", "replay:replay", "Simulate an exported model in MuJoCo along a dataset's motions."),
        ),
        "Simulated machines and studies": (
            ("demo", "simulate:demo", "Simulate a robot, identify it, and compare with the truth."),
            ("simulate", "simulate:simulate", "Simulate a scenario and write its measurements as a dataset."),
            ("sweep", "sweep:sweep", "Run a sweep of scenarios: noise, gains, payloads, estimators."),
            ("table", "sweep:table", "Summarise the runs of a sweep by axis."),
            ("plot", "sweep:plot", "Draw a metric of a sweep against an axis."),
            ("trial", "trial:trial", "Diagnose simulated machines whose hidden effects are known."),
            ("check", "sweep:check", "Compare the accuracy with the reference; fail if it is worse."),
        ),
    }.items()
    for name, target, text in commands
}

BAD_INPUT = 2
INTERRUPTED = 130  # 128 + SIGINT, as a shell reports it
OLD_MJCF = ".* is deprecated and will be removed in a future release"  # on attributes of older files


@click.group(cls=LazyGroup, lazy_commands=COMMANDS, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="parabench")
def cli() -> None:
    """Identify the drive gains and dynamic parameters of a robot from its logs.

    DATASET is a folder with a dataset.toml and recordings; ROBOT is a built-in name or the path of a
    robot folder.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command `bench` and return its exit code.

    `arguments` are the words after `bench`, those of the process if None. 0: done. 1: the accuracy is worse, or all
    runs of a study failed. 2: a mistake in the user's input, reported in one line on standard error. 130 and 143:
    interrupted or terminated; files that were being written keep their old content. A closed standard output does not
    change the exit code.
    """
    os.environ.setdefault(
        "MUJOCO_GL", "disable"
    )  # no command renders with MuJoCo, whose window libraries are slow to import
    warnings.filterwarnings("ignore", message=OLD_MJCF, category=UserWarning)  # MuJoCo prints it as well
    try:
        with leaving_on_termination(lambda: _say("terminated", TERMINATED)), forgiving_output():
            result = cli.main(args=arguments, prog_name=called_as(), standalone_mode=False)
    except BenchError as error:
        for line in lines_of(error):
            _say(line, BAD_INPUT)
        return BAD_INPUT
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return error.exit_code
    except click.UsageError as error:
        said = error.format_message()
        if isinstance(error, click.NoSuchOption | click.NoSuchCommand):
            said = misspelt(error)
        see = error.ctx.command_path if error.ctx else called_as()
        return _say(f"{said} (see: {see} --help)", error.exit_code)
    except click.ClickException as error:
        return _say(error.format_message(), error.exit_code)
    except click.Abort:
        return _say("interrupted", INTERRUPTED)
    return result if isinstance(result, int) else 0


def _say(message: str, exit_code: int) -> int:
    """Print the message as one line, without line breaks, and return the exit code."""
    click.echo(f"bench: {' '.join(message.split())}", err=True)
    return exit_code
