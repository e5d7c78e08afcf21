"""The motion as files: for a robot's controller, for a scenario, and for people."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import whole_folder, write_json_atomically, write_text_atomically
from bench.basics.plain_data import finite
from bench.dataset.recording import write_table
from bench.excitation.discrimination.result import Discrimination, MotionFacts
from bench.excitation.discrimination.sentences import length_unit, sentences
from bench.scenario.trajectory import FourierTrajectory

TRAJECTORY, COEFFICIENTS, SUMMARY, ANSWER, PICTURE = (
    "trajectory.csv",
    "trajectory.toml",
    "README.md",
    "answer.json",
    "motion.png",
)

Draw = Callable[[Path, Discrimination], None]


@dataclass(frozen=True)
class CommandLines:
    """Command lines, as a shell takes them. designed: the one that designed the motion; diagnose: with the
    same model, once its logs are there; robot: a name or a folder.
    """

    designed: str
    diagnose: str
    dataset: str
    robot: str


PLAIN = CommandLines(
    "bench discriminate DATASET EFFECT_A EFFECT_B -o DIR", "bench diagnose DATASET", "DATASET", "ROBOT"
)


def write_discrimination(
    folder: str | Path,
    result: Discrimination,
    draw: Draw,
    *,
    rate: float = 1000.0,
    commands: CommandLines = PLAIN,
) -> list[Path]:
    """Write the folder completely or not at all, and return its files; replaces one of an earlier call.

    rate: of the trajectory table, Hz. draw: draws the picture at a path. commands: the command lines for the README.
    Raises BenchError if the folder has other content, or cannot be written.
    """
    return written_whole(folder, (ANSWER,), lambda partial: _write(partial, result, draw, rate, commands))


def written_whole(folder: str | Path, marks: Sequence[str], write: Callable[[Path], None]) -> list[Path]:
    """Write a folder completely or not at all, and return its files; marks: see `check_folder`."""
    check_folder(folder, *marks)
    with whole_folder(folder) as partial:
        write(partial)
        names = sorted(path.name for path in partial.iterdir())
    return [Path(folder) / name for name in names]


def check_folder(folder: str | Path, *marks: str) -> None:
    """Raise BenchError if the folder has content, but not the files `marks` of an earlier call."""
    target = Path(folder)
    empty = not target.exists() or (target.is_dir() and not any(target.iterdir()))
    if not empty and not all((target / mark).is_file() for mark in marks):
        raise BenchError(f"{folder}: is there already and holds something else: name another folder")


def trajectory_table(trajectory: FourierTrajectory, joints: list[str], rate: float) -> dict[str, np.ndarray]:
    """Columns time, position.JOINT, velocity.JOINT and acceleration.JOINT, each (N,): s, rad or m and rates."""
    time = np.arange(int(trajectory.duration * rate) + 1) / rate
    columns = {"time": time}
    for kind, values in zip(("position", "velocity", "acceleration"), trajectory.evaluate(time), strict=True):
        columns |= {f"{kind}.{joint}": values[:, j] for j, joint in enumerate(joints)}
    return columns


def discrimination_json(result: Discrimination) -> dict[str, Any]:
    """The answer as plain data, ready for JSON."""
    motion = result.motion
    answer = {
        "robot": result.robot,
        "effects": list(result.effects),
        "tells": result.tells,
        "error_over_noise": result.error_over_noise,
        "shown": dict(result.shown),
        "nothing_to_tell_apart": result.nothing,
        "absorbed": list(result.absorbed),
        "imitated": list(result.imitated),
        "given": dict(result.given),
        "promised": dict(result.promised),
        "error_growth": result.growth,
        "payload": None if motion is None else motion.payload,
        "trajectory": None if motion is None else motion.trajectory.to_dict(),
        "wider": None if result.wider is None else {"widen": result.wider[0], "nats": result.wider[1]},
        "second_payload": None
        if result.second is None
        else {"mass": result.second[0], "nats": result.second[1]},
        "summary": sentences(result),
    }
    return dict(finite(answer))


def _write(folder: Path, result: Discrimination, draw: Draw, rate: float, commands: CommandLines) -> None:
    if result.motion is not None:
        trajectory, joints = result.motion.trajectory, list(result.joints)
        write_table(folder / TRAJECTORY, trajectory_table(trajectory, joints, rate))
        write_text_atomically(folder / COEFFICIENTS, _coefficients(result, trajectory))
        draw(folder / PICTURE, result)
    write_text_atomically(folder / SUMMARY, _readme(result, rate, commands))
    write_json_atomically(folder / ANSWER, discrimination_json(result))


def _coefficients(result: Discrimination, trajectory: FourierTrajectory) -> str:
    lines = [
        f'# Joints: {", ".join(result.joints)}. In a scenario: trajectory_file = "{COEFFICIENTS}" of a recording.'
    ]
    lines += [f"{key} = {value!r}" for key, value in trajectory.to_dict().items()]
    return "\n".join(lines) + "\n"


def _readme(result: Discrimination, rate: float, commands: CommandLines) -> str:
    lines = [f"# {result.robot}: {' or '.join(result.effects)}?", ""]
    lines += [f"- {sentence}" for sentence in sentences(result)]
    if result.motion is None:
        return "\n".join([*lines, "", f"Asked by `{commands.designed}`."]) + "\n"
    into = f"--robot {commands.robot} -o {commands.dataset}"
    payload = f" --payload {result.motion.payload}" if result.motion.payload else ""
    inside = f'\npayload = "{result.motion.payload}"' if result.motion.payload else ""
    lines += ["", f"![The motion, and where the models differ]({PICTURE})", "", *_table(result), ""]
    lines += [
        "## Record it",
        "",
        f"1. Let the robot go to the first row of `{TRAJECTORY}`, slowly. Run the table at {rate:g} Hz (s; rad, m and",
        "   their rates) and log positions and currents. Run it twice: one log is fitted, the other one judges.",
        "2. Add both to the dataset:",
        "",
        "   ```sh",
        f"   bench import first.csv {into} --name telling.csv{payload}",
        f"   bench import second.csv {into} --name telling_check.csv --use validate{payload}",
        f"   {commands.diagnose}",
        "   ```",
        "",
        "To see it in simulation first, give a scenario this recording, and a second one with `validate`:",
        "",
        "```toml",
        "[[recordings]]",
        'name = "telling"',
        f'use = "identify"{inside}',
        f'trajectory_file = "{COEFFICIENTS}"',
        "```",
        "",
        f"The motion was designed by `{commands.designed}`.",
    ]
    return "\n".join(lines) + "\n"


def _table(result: Discrimination) -> list[str]:
    """Facts of every joint, recorded and planned, as a Markdown table."""
    lines = [
        "| motor | | from | to | speed | acceleration | reversals a second |",
        "|---|---|---:|---:|---:|---:|---:|",
    ]

    def row(joint: str, what: str, motion: MotionFacts) -> str:
        values = (motion.low, motion.high, motion.speed, motion.acceleration, motion.reversals)
        return f"| {joint} | {what} | {' | '.join(f'{value:.3g}' for value in values)} |"

    for joint, facts in result.planned.items():
        motor = f"{joint} [{length_unit(result, joint)}, s]"
        lines += [row(motor, "recorded", result.recorded[joint]), row("", "this motion", facts)]
    return lines
