"""Run a plan: shared tasks first, then the runs that need them; finished runs are stored at once."""

import json
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain, groupby
from pathlib import Path
from typing import Any

from bench.basics.files.atomic import write_json_atomically
from bench.scenario.trajectory import FourierTrajectory
from bench.studies.sweep.journal import Journal, Row
from bench.studies.sweep.plan import Run
from bench.studies.sweep.pool import Outcome, Pool, Shared, Task

LOOK_AHEAD = 4  # sets of equations per worker: shared motions are simulated while these are processed
FEWEST_AHEAD = 8
KEPT = -1  # replaces the key of a task for a design that exists already

Report = Callable[[Journal], None]
"""Called whenever runs are finished."""
Phase = Callable[[str], None]
"""Called with the current phase before any run is finished."""


def silent(_: str) -> None:
    """Ignore the phase."""


@dataclass(frozen=True)
class Work:
    """The tasks of a sweep.

    design: designs trajectories, by recording name. motion: simulates a motion along trajectories that several sets
    of runs share. runs: computes a row for each of the runs with the same equations, from the shared motion, or from
    None if no other set shares it. failed: the row of a failed run, with the reason.
    """

    design: Callable[[Run], Task]
    motion: Callable[[Run, Any], Task]
    runs: Callable[[tuple[Run, ...], Any], Task]
    failed: Callable[[Run, str], Row]


@dataclass(frozen=True)
class _Set:
    """Runs with the same equations. shared: whether other sets have the same motion."""

    runs: tuple[Run, ...]
    shared: bool


Commons = dict[str, Outcome]
"""Designs or motions by name: the value, or the reason for its failure."""


ReadyRuns = tuple[tuple[Run, ...], Any, Shared | None]
"""Runs with the same equations, their design, and their motion if it is shared."""


class Driver:
    """Runs all tasks and stores the rows.

    It holds only a window of sets in memory, independently of the number of runs. tasks: runs in order, grouped by
    equations. designs: folder of stored trajectories.
    """

    def __init__(
        self, tasks: Iterable[tuple[Run, ...]], journal: Journal, pool: Pool, work: Work, designs: Path
    ) -> None:
        self._journal, self._pool, self._work, self._folder = journal, pool, work, designs
        self._sets = _sets(tasks)
        self._limit = max(FEWEST_AHEAD, LOOK_AHEAD * pool.slots)
        self._waiting: list[_Set] = []
        self._ready: deque[ReadyRuns] = deque()
        self._designs: Commons = {}
        self._motions: Commons = {}
        self._asked: dict[str, Commons] = {}
        self._jobs: dict[int, Callable[[Outcome], None]] = {}  # what takes the outcome of each task
        self._running = 0
        self._next = 0

    def run(self, report: Report, phase: Phase = silent) -> None:
        """Work until all runs are finished. The cost of a finished run does not depend on the number of
        pending runs.
        """
        more_to_come = True
        while more_to_come or self._ready or self._jobs:  # no set waits if no task is running
            while more_to_come and len(self._waiting) + len(self._ready) < self._limit:
                following = next(self._sets, None)
                more_to_come = following is not None
                if following is not None and not self._placed(following):
                    self._waiting.append(following)
            while self._ready and self._running <= self._pool.slots:
                self._submit_runs(*self._ready.popleft())
            if self._jobs:
                phase(self._doing())
                for outcome in self._pool.outcomes():
                    self._jobs.pop(outcome.key)(outcome)
            report(self._journal)

    def _placed(self, run_set: _Set) -> bool:
        """Take the next step for a set; return whether its runs only need a free slot, or have failed."""
        first = run_set.runs[0]
        if (
            first.design not in self._designs
            and (kept := kept_design(self._folder, first.design)) is not None
        ):
            self._designs[first.design] = Outcome(KEPT, kept, None)
        design = self._designs.get(first.design)
        if design is None:
            self._ask(self._designs, first.design, lambda: self._work.design(first))
            return False
        if design.fault is not None:
            return self._fail(run_set.runs, design.fault)
        motion = None
        if run_set.shared:
            common = self._motions.get(first.motion)
            if common is None:
                self._ask(self._motions, first.motion, lambda: self._work.motion(first, design.value))
                return False
            if common.fault is not None:
                return self._fail(run_set.runs, common.fault)
            motion = Shared(first.motion, common.value)
        self._ready.append((run_set.runs, design.value, motion))
        return True

    def _doing(self) -> str:
        """The phase that the next runs are waiting for."""
        if any(stage is self._designs for stage in self._asked.values()):
            return "designing trajectories"
        return "simulating shared motions" if self._asked and not self._running else "runs"

    def _ask(self, results: Commons, name: str, task: Callable[[], Task]) -> None:
        if name not in self._asked:
            self._asked[name] = results
            self._submit(task(), None, lambda outcome: self._take_common(results, name, outcome))

    def _submit_runs(self, runs: tuple[Run, ...], design: Any, motion: Shared | None) -> None:
        def take(outcome: Outcome) -> None:
            self._running -= 1
            if outcome.fault is None:
                self._journal.save_rows(outcome.value)
            elif len(runs) > 1:  # one of them fails: run each alone
                for run in runs:
                    self._submit_runs((run,), design, motion)
            else:
                self._fail(runs, outcome.fault)

        self._running += 1
        self._submit(self._work.runs(runs, design), motion, take)

    def _submit(self, task: Task, shared: Shared | None, take: Callable[[Outcome], None]) -> None:
        self._jobs[self._next] = take
        self._pool.submit(self._next, task, shared)
        self._next += 1

    def _fail(self, runs: tuple[Run, ...], reason: str) -> bool:
        self._journal.save_rows([self._work.failed(run, reason) for run in runs])
        return True

    def _take_common(self, results: Commons, name: str, outcome: Outcome) -> None:
        """Continue the sets that waited for a design or a motion, and discard those that no set waits for.

        Sets that share a value are adjacent, so later sets need at most the values that waiting sets need.
        """
        del self._asked[name]
        results[name] = outcome
        if results is self._designs and outcome.fault is None:
            keep_design(self._folder, name, outcome.value)
        needed = {
            key for run_set in self._waiting for key in (run_set.runs[0].design, run_set.runs[0].motion)
        }
        for known in (self._designs, self._motions):
            for key in known.keys() - needed:
                del known[key]
        self._waiting = [run_set for run_set in self._waiting if not self._placed(run_set)]


def _sets(tasks: Iterable[tuple[Run, ...]]) -> Iterator[_Set]:
    """Sets of runs with the same equations, in order; a motion is shared if an adjacent set has the same."""
    for _, same in groupby(tasks, key=lambda runs: runs[0].motion):
        group = iter(same)
        first, second = next(group), next(group, None)
        yield _Set(first, second is not None)
        if second is not None:
            yield from (_Set(runs, True) for runs in chain([second], group))


def keep_design(folder: Path, name: str, trajectories: Mapping[str, FourierTrajectory]) -> None:
    """Store trajectories, by recording name, exactly to the last bit."""
    content = {recording: trajectory.to_dict() for recording, trajectory in trajectories.items()}
    write_json_atomically(folder / f"{name}.json", content)


def kept_design(folder: Path, name: str) -> dict[str, FourierTrajectory] | None:
    """Read stored trajectories; None if there are none of that name."""
    path = folder / f"{name}.json"
    if not path.is_file():
        return None
    content = json.loads(path.read_text(encoding="utf-8"))
    return {recording: FourierTrajectory.from_dict(entry) for recording, entry in content.items()}
