"""`bench robot`: commands on a robot alone, without measurements."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from bench.cli.last_lines import next_line, say, write_answer, wrote
from bench.cli.options import assignment, json_option, path_option, robots

if TYPE_CHECKING:
    from bench.dataset.robot_toml import MjcfParts


@click.group("robot")
def robot() -> None:
    """Make and check a robot folder: joints, loops, home pose."""


@robot.command("check")
@click.argument("folder", metavar="FOLDER", shell_complete=robots)
@json_option
@click.option("-v", "--verbose", is_flag=True, help="List the base parameters and their groupings.")
def check(folder: str, json_file: Path | None, verbose: bool) -> None:
    """Check that a robot can be identified, and that Pinocchio and MuJoCo agree on it.

    FOLDER holds a robot.toml and its MJCF; the name of a built-in robot works as well.
    """
    from rich.console import Console

    from bench.basics.errors import BenchError
    from bench.dataset.robot import load_robot
    from bench.document.terminal.robot import robot_report
    from bench.robot_check.as_json import report_json
    from bench.robot_check.check import check_robot
    from bench.robot_check.words import detail_of, name_of

    report = check_robot(load_robot(folder))
    robot_report(report, Console(), verbose=verbose)
    if report.failures:
        first = report.failures[0]
        prefix = f"robot {report.robot.name}: "
        raise BenchError(f"{prefix}{name_of(first)}: {detail_of(first).removeprefix(prefix)}")
    if json_file is not None:
        write_answer(json_file, report_json(report))
        say([wrote(json_file, "answer")])
    say([next_line(["open", "--robot", folder] if Path(folder).is_dir() else ["open"], "imports its logs")])


@robot.command("new")
@click.argument("model", metavar="MODEL.xml", type=click.Path(path_type=Path))
@click.option(
    "--motor",
    "motors",
    type=assignment(float),
    multiple=True,
    metavar="NAME=GAIN",
    help="A motor: the joint that it drives (or a fixed tendon, or an actuator of the file with its gear) and its"
    " nominal drive gain. Repeat for each, in the order of all tables.",
)
@click.option(
    "--unit",
    type=click.Choice(["A", "V", "1"]),
    default="A",
    show_default=True,
    help="Unit of the drive commands: amperes or volts; 1: torques or forces are logged.",
)
@click.option("--tool", metavar="SITE", help="The site of the file at which a payload is fixed.")
@click.option(
    "--lock",
    "locked",
    type=assignment(float),
    multiple=True,
    metavar="JOINT=VALUE",
    help="A joint that is held, for example a gripper, and its position in rad or m. Repeat for each.",
)
@click.option("--name", help="The robot's name. [default: the file name without suffix]")
@path_option("-o", "--output", metavar="FOLDER", help="Folder for robot.toml. [default: that of the MJCF]")
@click.option("--overwrite", is_flag=True, help="Replace an existing robot.toml.")
def new(
    model: Path,
    motors: tuple[tuple[str, float], ...],
    unit: Literal["A", "V", "1"],
    tool: str | None,
    locked: tuple[tuple[str, float], ...],
    name: str | None,
    output: Path | None,
    overwrite: bool,
) -> None:
    """Write the robot.toml of an MJCF file: its motors, their nominal gains, tool and locked joints.

    Without --motor, it lists the joints, tendons, actuators and sites of MODEL.xml.
    """
    from bench.cli.options import unique
    from bench.dataset.names import ROBOT_FILE
    from bench.dataset.robot_toml import mjcf_parts, no_tool, write_robot_toml

    if not motors:
        raise click.UsageError(
            f"give each motor as --motor NAME=GAIN; {model} has {_listed(mjcf_parts(model))}"
        )
    unique(motors, "--motor")
    unique(locked, "--lock")
    held = dict(locked)
    folder = write_robot_toml(
        model, motors, unit=unit, tool=tool, locked=held, name=name, folder=output, overwrite=overwrite
    )
    hint = [f"note: {no_tool(mjcf_parts(model).sites)}; or repeat with --tool NAME --overwrite"]
    say([*([] if tool else hint), wrote(folder / ROBOT_FILE, "robot"), next_line(["robot", "check", folder])])


def _listed(parts: "MjcfParts") -> str:
    """The parts of the file, by kind."""
    named: dict[str, Sequence[str]] = {}
    for kind, noun in (("joint", "joints"), ("tendon", "fixed tendons"), ("motor", "actuators")):
        named[noun] = [part.name for part in parts.motors if part.drives == kind]
    named["sites"] = parts.sites
    listed = [f"{noun} {', '.join(names)}" for noun, names in named.items() if names]
    return "; ".join(listed) or "no joint with a name"
