"""The cases of an evaluation as runs, handed out as long as the budget lasts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from bench.benchmarks.trust.budget import Budget
from bench.benchmarks.trust.cells import TrustCase
from bench.benchmarks.trust.tally import Tally
from bench.studies.sweep.plan import Run, digest
from bench.studies.trial.plan import TrialPlan


@dataclass
class TrustPlan:
    """What is run next is decided when it is asked for, by what is finished then."""

    tally: Tally
    budget: Budget
    _plans: dict[tuple[str, str], TrialPlan] = field(default_factory=dict)

    def tasks(self, _is_done: Callable[[int], bool] = lambda _: False) -> Iterator[tuple[Run, ...]]:
        """Cases that are not done, until none remains or those that are handed out fill the budget."""
        while not self.budget.full(self.tally.pending_seconds):
            block = self.tally.next_block()
            if not block:
                return
            yield from ((self.run(case),) for case in block)

    def run(self, case: TrustCase) -> Run:
        """The case as a run: those of a robot have their trajectories and the undisturbed motion in common."""
        cell = case.cell
        key = cell.robot, cell.question.kind
        if key not in self._plans:
            self._plans[key] = TrialPlan(self.tally.cells.setups[cell.robot], cell.question.kind, 1)
        run = self._plans[key].run(case.number)
        return replace(run, number=case.row, equations=digest([run.equations, case.row]))
