"""The work of the evaluation: a case of a trial, diagnosed and judged as there, with its place and its cost."""

from __future__ import annotations

import time
from functools import partial

from bench.basics.errors import BenchError
from bench.benchmarks.trust.again import again_columns
from bench.benchmarks.trust.cells import TrustCase, TrustCells
from bench.benchmarks.trust.sizes import drawn_case
from bench.studies.sweep.journal import Row
from bench.studies.sweep.plan import Run
from bench.studies.sweep.pool import Task
from bench.studies.sweep.run_plan import Work
from bench.studies.sweep.work import Trajectories
from bench.studies.trial.cases import KINDS, Case
from bench.studies.trial.realise import realised
from bench.studies.trial.setup import Setup
from bench.studies.trial.work import diagnosed_row, failed_row, trial_trajectories, undisturbed
from bench.truth.hidden.reference import Reference
from bench.truth.simulate import Simulation

FRESH, FROZEN = "fresh", "frozen"
SECONDS, PROCESSOR = "seconds", "seconds.processor"
"""Columns of what a case took by the clock and of one processor; with `.again` for its further diagnoses."""

Place = dict[str, str | int]
"""The columns that say which case a row is of."""

NO_TIME = {SECONDS: 0.0, PROCESSOR: 0.0}


def case_rows(
    setup: Setup,
    place: Place,
    number: int,
    again: bool,
    trajectories: Trajectories,
    reference: Simulation | None = None,
) -> list[Row]:
    """Simulate one case and diagnose it: one row of this number. again: diagnose it under changed conditions, too.

    reference: the movements with nothing hidden; None: to be simulated.
    """
    begun = _clocks()
    case = _case(setup, place)
    try:
        without = reference or undisturbed(setup, trajectories)
        case, simulation = realised(setup, case, Reference(without), trajectories)
        row = diagnosed_row(setup, case, number, simulation)
        seconds = _since(begun)
        if again:
            begun = _clocks()
            row |= again_columns(simulation, row)
            seconds |= {f"{name}.again": value for name, value in _since(begun).items()}
    except BenchError as error:
        row = failed_row(setup, case, number, str(error))
        seconds = _since(begun)
    return [row | {**place} | seconds]


def trust_work(cells: TrustCells) -> Work:
    """The tasks of an evaluation."""

    def setup_of(run: Run) -> Setup:
        return cells.setups[cells.case_of_row(run.number).cell.robot]

    def runs(runs: tuple[Run, ...], trajectories: Trajectories) -> Task:
        (run,) = runs
        case = cells.case_of_row(run.number)
        return partial(case_rows, setup_of(run), place_of(case), run.number, case.again, trajectories)

    def failed(run: Run, reason: str) -> Row:
        setup, place = setup_of(run), place_of(cells.case_of_row(run.number))
        return failed_row(setup, _case(setup, place), run.number, reason) | place | NO_TIME

    return Work(
        design=lambda run: partial(trial_trajectories, setup_of(run)),
        motion=lambda run, trajectories: partial(undisturbed, setup_of(run), trajectories),
        runs=runs,
        failed=failed,
    )


def place_of(case: TrustCase) -> Place:
    """The columns that say which case a row is of."""
    return {
        "robot": case.cell.robot,
        "question": case.cell.question.kind,
        "set": FROZEN if case.cell.frozen else FRESH,
        "number": case.number,
    }


def _clocks() -> tuple[float, float]:
    return time.perf_counter(), time.thread_time()


def _since(begun: tuple[float, float]) -> dict[str, float]:
    clock, processor = (after - before for after, before in zip(_clocks(), begun, strict=True))
    return {SECONDS: clock, PROCESSOR: processor}


def _case(setup: Setup, place: Place) -> Case:
    kind = next(kind for kind in KINDS if kind == place["question"])
    return drawn_case(setup, kind, int(place["number"]))
