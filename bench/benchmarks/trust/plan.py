"""The cases of an evaluation as runs, handed out as long as the budget lasts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache

from bench.benchmarks.trust.budget import Budget
from bench.benchmarks.trust.cells import TrustCase, TrustCells
from bench.benchmarks.trust.tally import Tally
from bench.studies.sweep.plan import Run, digest
from bench.studies.trial.cases import Kind
from bench.studies.trial.plan import TrialPlan


def case_runs(cells: TrustCells, cases: Iterable[TrustCase]) -> Iterator[tuple[Run, ...]]:
    """The run of each case, with the number of its row.

    Those of a robot have their trajectories and the undisturbed motion in common.
    """

    @cache
    def plan(robot: str, kind: Kind) -> TrialPlan:
        return TrialPlan(cells.setups[robot], kind, 1)

    for case in cases:
        run = plan(case.cell.robot, case.cell.question.kind).run(case.number)
        yield (replace(run, number=case.row, equations=digest([run.equations, case.row])),)


def runs_within(tally: Tally, budget: Budget) -> Iterator[tuple[Run, ...]]:
    """Cases that are not done, until none remains or those that are handed out fill the budget.

    What is run next is decided when it is asked for, by what is finished then.
    """

    def cases() -> Iterator[TrustCase]:
        while not budget.full(tally.pending_seconds):
            block = tally.next_block()
            if not block:
                return
            yield from block

    return case_runs(tally.cells, cases())
