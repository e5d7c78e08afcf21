"""Running a plan: what is shared goes first, what needs it follows, finished runs are kept as they come."""

import json
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.basics.files.atomic import write_json_atomically
from bench.scenario.trajectory import FourierTrajectory
from bench.studies.sweep.journal import Journal, Row
from bench.studies.sweep.plan import Run
from bench.studies.sweep.pool import Outcome, Pool, Shared, Task

LOOK_AHEAD = 4  # sets of equations for each worker: shared motions are simulated while these are worked off
FEWEST_AHEAD = 8
KEPT = -1  # in place of the key of a task: a design that was there already

Report = Callable[[Journal], None]
"""Called whenever runs are finished."""
Phase = Callable[[str], None]
"""Called with what goes on before any run is finished."""


def silent(_: str) -> None:
    """Tell nobody of the phase."""


@dataclass(frozen=True)
class Work:
    """The tasks that a sweep is made of.

    design: finds trajectories, by recording name. motion: simulates, along trajectories, a motion that several sets of
    runs share. runs: gives a row for each of the runs, which have the same equations, from the motion that they share
    with others, or from None where it is theirs alone. failed: the row of a run that came to nothing, with the reason.
    """

    design: Callable[[Run], Task]
    motion: Callable[[Run, Any], Task]
    runs: Callable[[tuple[Run, ...], Any], Task]
    failed: Callable[[Run, str], Row]


@dataclass(frozen=True)
class _Set:
    """Runs with the same equations; `shared`: other sets have the same motion."""

    runs: tuple[Run, ...]
    shared: bool

    @property
    def design(self) -> str:
        return self.runs[0].design

    @property
    def motion(self) -> str:
        return self.runs[0].motion


Commons = dict[str, Outcome]
"""Designs or motions by name: each is there, or the reason why it is not."""


@dataclass(frozen=True)
class _CommonJob:
    """What finds a design or a motion."""

    results: Commons
    name: str


@dataclass(frozen=True)
class _RunJob:
    """What makes rows."""

    runs: tuple[Run, ...]
    design: Any
    motion: Shared | None


class Driver:
    """Runs all that is asked for, and keeps the rows.

    At any time it holds a window of sets of runs, whatever the number of runs. tasks: runs in order, those with the
    same equations together. designs: folder in which trajectories are kept.
    """

    def __init__(
        self, tasks: Iterable[tuple[Run, ...]], journal: Journal, pool: Pool, work: Work, designs: Path
    ) -> None:
        self._journal, self._pool, self._work, self._folder = journal, pool, work, designs
        self._sets = _sets(tasks)
        self._limit = max(FEWEST_AHEAD, LOOK_AHEAD * pool.slots)
        self._waiting: list[_Set] = []
        self._ready: deque[_RunJob] = deque()
        self._designs: Commons = {}
        self._motions: Commons = {}
        self._asked: dict[str, Commons] = {}
        self._jobs: dict[int, _CommonJob | _RunJob] = {}
        self._running = 0
        self._next = 0

    def run(self, report: Report, phase: Phase = silent) -> None:
        """Work until nothing remains; what a finished run costs does not depend on how many are under way."""
        more_to_come = True
        while more_to_come or self._ready or self._jobs:  # no set waits where nothing is under way
            while more_to_come and len(self._waiting) + len(self._ready) < self._limit:
                following = next(self._sets, None)
                more_to_come = following is not None
                if following is not None and not self._placed(following):
                    self._waiting.append(following)
            while self._ready and self._running <= self._pool.slots:
                self._submit_runs(self._ready.popleft())
            if self._jobs:
                phase(self._doing())
                for outcome in self._pool.outcomes():
                    self._take(outcome)
            report(self._journal)

    def _placed(self, run_set: _Set) -> bool:
        """Take the next step towards the runs of a set; whether they need no more than a free slot, or have failed."""
        first = run_set.runs[0]
        if (
            run_set.design not in self._designs
            and (kept := kept_design(self._folder, run_set.design)) is not None
        ):
            self._designs[run_set.design] = Outcome(KEPT, kept, None)
        design = self._designs.get(run_set.design)
        if design is None:
            self._ask(_CommonJob(self._designs, run_set.design), lambda: self._work.design(first))
            return False
        if design.fault is not None:
            return self._fail(run_set.runs, design.fault)
        motion = None
        if run_set.shared:
            if run_set.motion not in self._motions:
                job = _CommonJob(self._motions, run_set.motion)
                self._ask(job, lambda: self._work.motion(first, design.value))
                return False
            common = self._motions[run_set.motion]
            if common.fault is not None:
                return self._fail(run_set.runs, common.fault)
            motion = Shared(run_set.motion, common.value)
        self._ready.append(_RunJob(run_set.runs, design.value, motion))
        return True

    def _doing(self) -> str:
        """What the runs that come next are waiting for."""
        if any(stage is self._designs for stage in self._asked.values()):
            return "designing trajectories"
        return "simulating shared motions" if self._asked and not self._running else "runs"

    def _ask(self, job: _CommonJob, task: Callable[[], Task]) -> None:
        if job.name not in self._asked:
            self._asked[job.name] = job.results
            self._submit(job, task())

    def _submit_runs(self, job: _RunJob) -> None:
        self._running += 1
        self._submit(job, self._work.runs(job.runs, job.design), job.motion)

    def _submit(self, job: _CommonJob | _RunJob, task: Task, shared: Shared | None = None) -> None:
        self._jobs[self._next] = job
        self._pool.submit(self._next, task, shared)
        self._next += 1

    def _fail(self, runs: tuple[Run, ...], reason: str) -> bool:
        self._journal.append([self._work.failed(run, reason) for run in runs])
        return True

    def _take(self, outcome: Outcome) -> None:
        job = self._jobs.pop(outcome.key)
        if isinstance(job, _CommonJob):
            self._take_common(job, outcome)
            return
        self._running -= 1
        if outcome.fault is None:
            self._journal.append(outcome.value)
        elif len(job.runs) > 1:  # one of them is at fault: find out which
            for run in job.runs:
                self._submit_runs(_RunJob((run,), job.design, job.motion))
        else:
            self._fail(job.runs, outcome.fault)

    def _take_common(self, job: _CommonJob, outcome: Outcome) -> None:
        """Go on with the sets that waited for a design or a motion; what no set waits for is given up.

        Sets that share something are side by side: those that are still to come need what the last ones need.
        """
        del self._asked[job.name]
        job.results[job.name] = outcome
        if job.results is self._designs and outcome.fault is None:
            keep_design(self._folder, job.name, outcome.value)
        for known, needed in (
            (self._designs, {run_set.design for run_set in self._waiting}),
            (self._motions, {run_set.motion for run_set in self._waiting}),
        ):
            for name in known.keys() - needed:
                del known[name]
        self._waiting = [run_set for run_set in self._waiting if not self._placed(run_set)]


def _sets(tasks: Iterable[tuple[Run, ...]]) -> Iterator[_Set]:
    """Sets of runs with the same equations, in order; motions are compared with the sets before and after."""
    before, current = "", None
    for following in tasks:
        if current is not None:
            yield _Set(current, current[0].motion in (before, following[0].motion))
            before = current[0].motion
        current = following
    if current is not None:
        yield _Set(current, current[0].motion == before)


def keep_design(folder: Path, name: str, trajectories: Mapping[str, FourierTrajectory]) -> None:
    """Write trajectories, by recording name, to the last bit."""
    content = {recording: trajectory.to_dict() for recording, trajectory in trajectories.items()}
    write_json_atomically(folder / f"{name}.json", content)


def kept_design(folder: Path, name: str) -> dict[str, FourierTrajectory] | None:
    """Read them again; None if there are none of that name."""
    path = folder / f"{name}.json"
    if not path.is_file():
        return None
    content = json.loads(path.read_text(encoding="utf-8"))
    return {recording: FourierTrajectory.from_dict(entry) for recording, entry in content.items()}
