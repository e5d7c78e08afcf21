"""The cases of an evaluation as runs, handed out as long as the budget lasts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from bench.benchmarks.trust.budget import Budget
from bench.benchmarks.trust.case_runs import CaseRuns
from bench.benchmarks.trust.tally import Tally
from bench.studies.sweep.plan import Run


@dataclass
class TrustPlan:
    """What is run next is decided when it is asked for, by what is finished then."""

    tally: Tally
    budget: Budget

    def tasks(self, _is_done: Callable[[int], bool] = lambda _: False) -> Iterator[tuple[Run, ...]]:
        """Cases that are not done, until none remains or those that are handed out fill the budget."""
        runs = CaseRuns(self.tally.cells)
        while not self.budget.full(self.tally.pending_seconds):
            block = self.tally.next_block()
            if not block:
                return
            yield from ((runs.run(case),) for case in block)
