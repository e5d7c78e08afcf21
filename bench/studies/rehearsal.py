"""Simulate a planned experiment before its scenario is written, to choose a drive with which it runs."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.basics.quiet import unwarned
from bench.excitation.experiment.files import scenario_text
from bench.excitation.experiment.plan import ExperimentPlan
from bench.excitation.experiment.simulated import DRIVES, FIRST, SimulatedDrive
from bench.scenario.scenario import Scenario, scenario_from_dict
from bench.truth.simulate import simulate


@dataclass(frozen=True)
class Refused:
    """A drive with which a planned scenario does not run, and the reason."""

    drive: SimulatedDrive
    why: str


@dataclass(frozen=True)
class Rehearsal:
    """drive: for the scenario; runs: whether every recording was simulated to its end; refused: the drives tried
    before it, or all if none runs.
    """

    drive: SimulatedDrive
    runs: bool
    refused: tuple[Refused, ...]


def rehearse(
    plan: ExperimentPlan, drives: Sequence[SimulatedDrive] = DRIVES, progress: Progress = SILENT
) -> Rehearsal:
    """The first of the drives with which all recordings of a plan can be simulated; the first drive if there
    is none.
    """
    refused: list[Refused] = []
    for drive in drives:
        try:
            with unwarned():
                simulate(scenario_of(plan, drive), progress=progress)
        except BenchError as error:
            refused.append(Refused(drive, str(error)))
        else:
            return Rehearsal(drive, True, tuple(refused))
    return Rehearsal(drives[0], False, tuple(refused))


def scenario_of(plan: ExperimentPlan, drive: SimulatedDrive = FIRST) -> Scenario:
    """The scenario that is written for a plan, including its motions."""
    content = tomllib.loads(scenario_text(plan, drive))
    for entry, recording in zip(content["recordings"], plan.recordings, strict=True):
        del entry["trajectory_file"]
        entry["trajectory"] = recording.trajectory.to_dict()
    return scenario_from_dict(content, f"{plan.robot.name}_planned", robot=plan.robot)


def rehearsal_sentence(rehearsal: Rehearsal) -> str:
    """A sentence on the drive that replaces the first one, or that none runs; "" if the first one runs."""
    if not rehearsal.refused:
        return ""
    if rehearsal.runs:
        first = rehearsal.refused[0]
        taken, other = _described(rehearsal.drive), _described(first.drive)
        return f"The scenario simulates {taken}, because {other} fails: {first.why}."
    last = rehearsal.refused[-1]
    return f"The scenario cannot be simulated. With {_described(last.drive)}, the last attempt: {last.why}."


def _described(drive: SimulatedDrive) -> str:
    return f"a controller of {drive.natural_frequency:g} Hz in steps of {1e3 * drive.step:g} ms"
