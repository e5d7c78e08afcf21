"""`bench robot`: what concerns a robot alone, without measurements."""

from pathlib import Path

import click

from bench.cli.completion import robots
from bench.cli.last_lines import next_line, say, write_answer, wrote
from bench.cli.options import json_option


@click.group("robot")
def robot() -> None:
    """Check a robot folder: joints, loops, home pose, singularities."""


@robot.command("check")
@click.argument("folder", metavar="FOLDER", shell_complete=robots)
@json_option
@click.option("-v", "--verbose", is_flag=True, help="List the base parameters and what they stand for.")
def check(folder: str, json_file: Path | None, verbose: bool) -> None:
    """Check that a robot can be identified, and that Pinocchio and MuJoCo agree on it.

    FOLDER holds a robot.toml beside its MJCF; the name of a built-in robot serves as well.
    """
    from rich.console import Console

    from bench.basics.errors import BenchError
    from bench.dataset.robot import load_robot
    from bench.document.terminal.robot import robot_report
    from bench.robot_check.as_json import report_json
    from bench.robot_check.check import check_robot

    report = check_robot(load_robot(folder))
    robot_report(report, Console(), verbose=verbose)
    if report.failures:
        first = report.failures[0]
        prefix = f"robot {report.robot.name}: "
        raise BenchError(f"{prefix}{first.name}: {first.detail.removeprefix(prefix)}")
    if json_file is not None:
        write_answer(json_file, report_json(report))
        say([wrote(json_file, "answer")])
    say([next_line(["open", "--robot", folder] if Path(folder).is_dir() else ["open"], "takes its logs")])
