"""One case run again, to see what went wrong."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from bench.basics.errors import BenchError
from bench.benchmarks.trust.others import OTHERS, scenarios_of_others
from bench.benchmarks.trust.run import setups_of
from bench.benchmarks.trust.stability import NOISE, SURE, WITHOUT_LOG
from bench.benchmarks.trust.words import answer_text, hidden_text
from bench.benchmarks.trust.work import case_rows
from bench.studies.sweep.journal import OK
from bench.studies.trial.cases import KINDS
from bench.studies.trial.work import trial_trajectories


def case_lines(name: str, also: Sequence[str], folder: Path) -> Iterator[str]:
    """Run the case ROBOT/QUESTION/NUMBER: the hidden effects and the diagnosis, as lines.

    also: robot folders or scenario files of robots that are not built in; folder: receives robots that have to be
    prepared.
    Raises BenchError if `name` is not a case.
    """
    robot, kind, number = ["", "", *name.rsplit("/", 2)][-3:]
    if not robot or kind not in KINDS or not number.isdecimal():
        raise BenchError(f"--case {name}: give ROBOT/QUESTION/NUMBER; questions are {', '.join(KINDS)}")
    setup = setups_of([*also, *scenarios_of_others(folder, [each for each in OTHERS if each == robot])]).get(
        robot
    )
    if setup is None:
        (setup,) = setups_of([robot]).values()
    place: dict[str, str | int] = {"robot": robot, "question": kind, "number": int(number)}
    (row,) = case_rows(setup, place, 0, True, trial_trajectories(setup))
    yield f"hidden: {hidden_text(row)}"
    if row["status"] != OK:
        yield f"failed: {row['reason']}"
        return
    yield f"answer: {answer_text(row)}"
    yield f"parameters: {row['parameters']}"
    before, after = (row[f"error_over_floor.{when}"] for when in ("before", "after"))
    yield f"error over the noise floor: {before:.3g} before, {after:.3g} after"
    for verdict in json.loads(row["verdicts"]):
        probability = verdict["probability"]
        stated = "" if probability is None else f", probability {probability:.3f}"
        yield f"{verdict['effect']}: {verdict['verdict']} at {', '.join(verdict['actuators'])}{stated}"
    yield f"certain: {row[SURE]}; with more noise: {row[NOISE]}; without a log: {row.get(WITHOUT_LOG)}"
