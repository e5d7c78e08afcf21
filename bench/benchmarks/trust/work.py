"""The work of the evaluation: a case of a trial, diagnosed and judged as there, with its place and its cost."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from bench.basics.errors import BenchError
from bench.benchmarks.trust.again import again_columns
from bench.benchmarks.trust.cells import TrustCase, TrustCells
from bench.benchmarks.trust.sizes import drawn_case
from bench.studies.sweep.journal import Row
from bench.studies.sweep.plan import Run
from bench.studies.sweep.pool import Task
from bench.studies.sweep.work import Trajectories
from bench.studies.trial.cases import KINDS, Case
from bench.studies.trial.realise import realised
from bench.studies.trial.setup import Setup
from bench.studies.trial.work import ReferenceTask, TrialDesignTask, diagnosed_row, failed_row
from bench.truth.hidden.reference import Reference
from bench.truth.simulate import Simulation

FRESH, FROZEN = "fresh", "frozen"
SECONDS, PROCESSOR = "seconds", "seconds.processor"
"""Columns of what a case took by the clock and of one processor; with `.again` for its further diagnoses."""

NO_TIME = {SECONDS: 0.0, PROCESSOR: 0.0}


@dataclass(frozen=True)
class TrustTask:
    """Simulate one case, diagnose it, and where that is asked for again under changed conditions."""

    setup: Setup
    place: Mapping[str, str | int]
    row: int
    again: bool
    trajectories: Trajectories

    def __call__(self, reference: Simulation | None) -> list[Row]:
        """One row. reference: the movements with nothing hidden; None: the task simulates them."""
        begun = _clocks()
        case = _case(self.setup, self.place)
        try:
            without = reference or ReferenceTask(self.setup, self.trajectories)(None)
            case, simulation = realised(self.setup, case, Reference(without), self.trajectories)
            row = diagnosed_row(self.setup, case, self.row, simulation)
            seconds = _since(begun)
            if self.again:
                begun = _clocks()
                row |= again_columns(simulation, row)
                seconds |= {f"{name}.again": value for name, value in _since(begun).items()}
        except BenchError as error:
            row = failed_row(self.setup, case, self.row, str(error))
            seconds = _since(begun)
        return [row | {**self.place} | seconds]


@dataclass(frozen=True)
class TrustWork:
    """The tasks of an evaluation."""

    cells: TrustCells

    def design(self, run: Run) -> Task:
        """Finds the trajectories of a robot."""
        return TrialDesignTask(self._setup(run))

    def motion(self, run: Run, trajectories: Trajectories) -> Task:
        """Simulates the movements with nothing hidden."""
        return ReferenceTask(self._setup(run), trajectories)

    def runs(self, runs: tuple[Run, ...], trajectories: Trajectories) -> Task:
        """Simulates and diagnoses a case."""
        (run,) = runs
        case = self.cells.case_of_row(run.number)
        return TrustTask(self._setup(run), place_of(case), run.number, case.again, trajectories)

    def failed(self, run: Run, reason: str) -> Row:
        """The row of a case that came to nothing."""
        case, setup = self.cells.case_of_row(run.number), self._setup(run)
        place = place_of(case)
        return failed_row(setup, _case(setup, place), run.number, reason) | place | NO_TIME

    def _setup(self, run: Run) -> Setup:
        return self.cells.setups[self.cells.case_of_row(run.number).cell.robot]


def place_of(case: TrustCase) -> dict[str, str | int]:
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


def _case(setup: Setup, place: Mapping[str, str | int]) -> Case:
    kind = next(kind for kind in KINDS if kind == place["question"])
    return drawn_case(setup, kind, int(place["number"]))
