"""Run the cases of a trial and store their rows."""

import json
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack, closing
from dataclasses import dataclass, field
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically
from bench.studies.sweep.journal import Journal, Row
from bench.studies.sweep.plan import digest
from bench.studies.sweep.pool import Pool
from bench.studies.sweep.run_plan import Driver, Phase, Report, silent
from bench.studies.trial.cases import KINDS, RULES, Kind, TrialPlan
from bench.studies.trial.setup import Setup
from bench.studies.trial.work import trial_work

DESIGNS = "designs"


@dataclass(frozen=True)
class TrialRequest:
    """The request for a trial. seeds: see `datasets_a_seed`. effects: draw from these; empty: from all.

    first: number of the first dataset of every kind. given: other arguments of the command (robot, scenario,
    duration), only for display.
    """

    setup: Setup
    kinds: tuple[Kind, ...]
    seeds: int
    effects: tuple[str, ...] = ()
    given: Mapping[str, str | float] = field(default_factory=dict)
    first: int = 0

    @property
    def plans(self) -> tuple[TrialPlan, ...]:
        """A plan for each kind with at least one case."""
        plans = (TrialPlan(self.setup, kind, self.seeds, self.effects, self.first) for kind in self.kinds)
        return tuple(plan for plan in plans if plan.size)


def run_trial(
    request: TrialRequest,
    folder: Path,
    make_pool: Callable[[], AbstractContextManager[Pool]],
    progress: Callable[[TrialPlan], Report],
    phase: Phase = silent,
) -> list[Row]:
    """Run all cases that are not yet in `folder`; returns all rows in it.

    After an interruption, it continues. More seeds or kinds add rows, which do not depend on the number of workers.
    Raises BenchError if the folder belongs to another trial.
    """
    for plan in request.plans:
        _claim(plan, folder, request.given)
    pool: Pool | None = None
    with ExitStack() as stack:
        for plan in request.plans:
            most = max(plan.numbers.stop, _rows_there(folder, plan.kind))
            with closing(Journal(_journal_path(folder, plan.kind), most)) as journal:
                if any(number not in journal for number in plan.numbers):
                    report = progress(plan)
                    phase("starting workers")
                    pool = pool or stack.enter_context(make_pool())
                    tasks = plan.tasks(journal.__contains__)
                    Driver(tasks, journal, pool, trial_work(plan), folder / DESIGNS).run(report, phase)
    return read_rows(folder)


def read_rows(folder: Path) -> list[Row]:
    """The rows of all finished cases, by kind and number."""
    rows: list[Row] = []
    for kind in KINDS:
        path = _journal_path(folder, kind)
        if path.is_file():
            with closing(Journal(path, _rows_there(folder, kind))) as journal:
                rows += journal.rows()
    return rows


def _journal_path(folder: Path, kind: Kind) -> Path:
    return folder / f"{kind}.jsonl"


def _rows_there(folder: Path, kind: Kind) -> int:
    """One more than the largest number of a complete row."""
    path = _journal_path(folder, kind)
    if not path.is_file():
        return 0
    with path.open("rb") as file:
        return max((json.loads(line)["run"] + 1 for line in file if line.endswith(b"\n")), default=0)


def _claim(plan: TrialPlan, folder: Path, given: Mapping[str, str | float]) -> None:
    """Mark the cases of a kind in a folder as belonging to this trial, for any number of seeds; BenchError if they do
    not.
    """
    record = folder / f"{plan.kind}.json"
    content = {
        "robot": plan.setup.name,
        "kind": plan.kind,
        "effects": list(plan.effects),
        "digest": digest([plan.setup.content, list(plan.setup.effects), RULES, plan.setup.discover]),
    }
    if record.is_file():
        there = json.loads(record.read_text(encoding="utf-8"))
        there.pop("given", None)
        if there != content:
            raise BenchError(
                f"{folder}: holds another trial of this robot, or an older version: give another folder with -o DIR"
            )
        return
    write_json_atomically(record, {**content, "given": dict(given)})
