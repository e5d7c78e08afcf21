"""The cases of an evaluation as runs, handed out within a time budget, and their progress."""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache

from rich.console import Console

from bench.basics.plural import plural
from bench.benchmarks.trust.cells import TrustCase, TrustCells
from bench.benchmarks.trust.tally import Tally
from bench.studies.sweep.journal import Journal
from bench.studies.sweep.plan import Run, digest
from bench.studies.sweep.progress import SAY_EVERY, duration_text
from bench.studies.trial.cases import Kind, TrialPlan


@dataclass
class Budget:
    """A time budget. hours: of all workers in parallel. spent: seconds of work of cases from earlier starts.

    slots: current number of workers.
    """

    hours: float
    spent: float
    slots: Callable[[], int]
    now: Callable[[], float] = time.monotonic
    begun: float = field(init=False)

    def __post_init__(self) -> None:
        self.begun = self.now()

    @property
    def seconds(self) -> float:
        """Remaining time of every worker, s."""
        return 3600.0 * self.hours - self.spent / self.slots() - (self.now() - self.begun)

    def full(self, pending: float) -> bool:
        """Whether `pending` seconds of work fill the remaining time."""
        return pending / self.slots() >= self.seconds


def case_runs(cells: TrustCells, cases: Iterable[TrustCase]) -> Iterator[tuple[Run, ...]]:
    """The run of each case, with its row number.

    The runs of a robot share trajectories and the undisturbed motion.
    """

    @cache
    def plan(robot: str, kind: Kind) -> TrialPlan:
        return TrialPlan(cells.setups[robot], kind, 1)

    for case in cases:
        run = plan(case.cell.robot, case.cell.question.kind).run(case.number)
        yield (replace(run, number=case.row, equations=digest([run.equations, case.row])),)


def runs_within(tally: Tally, budget: Budget) -> Iterator[tuple[Run, ...]]:
    """Runs of unfinished cases, until none remains or those handed out fill the budget.

    Each is chosen only when it is requested, from the results at that time.
    """

    def cases() -> Iterator[TrustCase]:
        while not budget.full(tally.pending_seconds):
            block = tally.next_block()
            if not block:
                return
            yield from block

    return case_runs(tally.cells, cases())


class TrustProgress:
    """Prints a line on the progress every half minute."""

    def __init__(self, console: Console, tally: Tally, budget: Budget) -> None:
        self._console, self._tally, self._budget = console, tally, budget
        self._said = time.monotonic()

    def __call__(self, journal: Journal) -> None:
        """Print the progress if the last line is old enough."""
        now = time.monotonic()
        if now - self._said < SAY_EVERY:
            return
        self._said = now
        cases = plural(self._tally.finished, "case")
        failed = f", {len(journal.failed)} failed" if journal.failed else ""
        remaining = duration_text(seconds_remaining(self._tally, self._budget))
        self._console.print(f"{cases}{failed}, {remaining} remaining", highlight=False)


def seconds_remaining(tally: Tally, budget: Budget) -> float:
    """Seconds until the budget is spent or all cases are finished."""
    work = (tally.open_seconds + tally.pending_seconds) / budget.slots()
    return max(min(budget.seconds, work), 0.0)
