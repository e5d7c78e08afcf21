"""Cases of an evaluation as runs: those of a robot have their trajectories and the undisturbed motion in common."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from bench.benchmarks.trust.cells import TrustCase, TrustCells
from bench.studies.sweep.plan import Run, digest
from bench.studies.trial.plan import TrialPlan


@dataclass
class CaseRuns:
    """The run of any case."""

    cells: TrustCells
    _plans: dict[tuple[str, str], TrialPlan] = field(default_factory=dict)

    def run(self, case: TrustCase) -> Run:
        """With the number of its row."""
        cell = case.cell
        key = cell.robot, cell.question.kind
        if key not in self._plans:
            self._plans[key] = TrialPlan(self.cells.setups[cell.robot], cell.question.kind, 1)
        run = self._plans[key].run(case.number)
        return replace(run, number=case.row, equations=digest([run.equations, case.row]))


@dataclass(frozen=True)
class ListedCases:
    """A plan of given cases."""

    runs: CaseRuns
    cases: Sequence[TrustCase]

    def tasks(self, is_done: Callable[[int], bool] = lambda _: False) -> Iterator[tuple[Run, ...]]:
        """All that are not done, in order."""
        return ((self.runs.run(case),) for case in self.cases if not is_done(case.row))
