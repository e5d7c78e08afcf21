"""The motion as files: for a robot's controller, for a scenario, and for people."""

from collections.abc import Callable
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
class Told:
    """What commands are told of, as a shell takes it. designed: the one that designed the motion; diagnose: with the
    same model, once its logs are there; robot: a name or a folder.
    """

    designed: str
    diagnose: str
    dataset: str
    robot: str


PLAIN = Told(
    "bench discriminate DATASET EFFECT_A EFFECT_B -o DIR", "bench diagnose DATASET", "DATASET", "ROBOT"
)


def write_discrimination(
    folder: str | Path, found: Discrimination, draw: Draw, *, rate: float = 1000.0, told: Told = PLAIN
) -> list[Path]:
    """Write the folder, whole or not at all, and tell its files; one that an earlier call wrote is replaced.

    rate: samples a second, Hz, of the trajectory as a table. draw: draws the picture at a path. told: of the commands
    that the README names. Raises BenchError if the folder holds anything else, or cannot be written.
    """
    check_folder(folder)
    with whole_folder(folder) as partial:
        _write(partial, found, draw, rate, told)
        names = sorted(path.name for path in partial.iterdir())
    return [Path(folder) / name for name in names]


def check_folder(folder: str | Path) -> None:
    """Raise BenchError where the folder holds anything that `write_discrimination` did not write."""
    target = Path(folder)
    empty = not target.exists() or (target.is_dir() and not any(target.iterdir()))
    if not empty and not (target / ANSWER).is_file():
        raise BenchError(f"{folder}: is there already and holds something else: name another folder")


def trajectory_table(trajectory: FourierTrajectory, joints: list[str], rate: float) -> dict[str, np.ndarray]:
    """Columns time, position.JOINT, velocity.JOINT and acceleration.JOINT, each (N,): s, rad or m and rates."""
    time = np.arange(int(trajectory.duration * rate) + 1) / rate
    columns = {"time": time}
    for kind, values in zip(("position", "velocity", "acceleration"), trajectory.evaluate(time), strict=True):
        columns |= {f"{kind}.{joint}": values[:, j] for j, joint in enumerate(joints)}
    return columns


def discrimination_json(found: Discrimination) -> dict[str, Any]:
    """The answer as plain data, ready for JSON."""
    motion = found.motion
    answer = {
        "robot": found.robot,
        "effects": list(found.effects),
        "tells": found.tells,
        "error_over_noise": found.error_over_noise,
        "shown": dict(found.shown),
        "nothing_to_tell_apart": found.nothing,
        "absorbed": list(found.absorbed),
        "imitated": list(found.imitated),
        "given": dict(found.given),
        "promised": dict(found.promised),
        "error_growth": found.growth,
        "payload": None if motion is None else motion.payload,
        "trajectory": None if motion is None else motion.trajectory.to_dict(),
        "wider": None if found.wider is None else {"widen": found.wider[0], "nats": found.wider[1]},
        "second_payload": None
        if found.second is None
        else {"mass": found.second[0], "nats": found.second[1]},
        "summary": sentences(found),
    }
    return dict(finite(answer))


def _write(folder: Path, found: Discrimination, draw: Draw, rate: float, told: Told) -> None:
    if found.motion is not None:
        trajectory, joints = found.motion.trajectory, list(found.joints)
        write_table(folder / TRAJECTORY, trajectory_table(trajectory, joints, rate))
        write_text_atomically(folder / COEFFICIENTS, _coefficients(found, trajectory))
        draw(folder / PICTURE, found)
    write_text_atomically(folder / SUMMARY, _readme(found, rate, told))
    write_json_atomically(folder / ANSWER, discrimination_json(found))


def _coefficients(found: Discrimination, trajectory: FourierTrajectory) -> str:
    lines = [
        f'# Joints: {", ".join(found.joints)}. In a scenario: trajectory_file = "{COEFFICIENTS}" of a recording.'
    ]
    lines += [f"{key} = {value!r}" for key, value in trajectory.to_dict().items()]
    return "\n".join(lines) + "\n"


def _readme(found: Discrimination, rate: float, told: Told) -> str:
    lines = [f"# {found.robot}: {' or '.join(found.effects)}?", ""]
    lines += [f"- {sentence}" for sentence in sentences(found)]
    if found.motion is None:
        return "\n".join([*lines, "", f"Asked by `{told.designed}`."]) + "\n"
    into = f"--robot {told.robot} -o {told.dataset}"
    payload = f" --payload {found.motion.payload}" if found.motion.payload else ""
    inside = f'\npayload = "{found.motion.payload}"' if found.motion.payload else ""
    lines += ["", f"![The motion, and where the models differ]({PICTURE})", "", *_table(found), ""]
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
        f"   {told.diagnose}",
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
        f"The motion was designed by `{told.designed}`.",
    ]
    return "\n".join(lines) + "\n"


def _table(found: Discrimination) -> list[str]:
    """Facts of every joint, recorded and planned, as a Markdown table."""
    lines = [
        "| motor | | from | to | speed | acceleration | reversals a second |",
        "|---|---|---:|---:|---:|---:|---:|",
    ]

    def row(joint: str, what: str, motion: MotionFacts) -> str:
        values = (motion.low, motion.high, motion.speed, motion.acceleration, motion.reversals)
        return f"| {joint} | {what} | {' | '.join(f'{value:.3g}' for value in values)} |"

    for joint, facts in found.planned.items():
        motor = f"{joint} [{length_unit(found, joint)}, s]"
        lines += [row(motor, "recorded", found.recorded[joint]), row("", "this motion", facts)]
    return lines
