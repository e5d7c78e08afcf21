"""An evaluation, from its cells to its rows, which are saved as they arrive."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically
from bench.basics.versions import versions
from bench.benchmarks.trust.cells import TrustCells
from bench.benchmarks.trust.plan import Budget, runs_within
from bench.benchmarks.trust.tally import Tally
from bench.benchmarks.trust.work import trust_work
from bench.scenario.file import find_scenario, read_with_bases
from bench.studies.sweep.journal import Journal, Row
from bench.studies.sweep.plan import digest
from bench.studies.sweep.pool import Pool
from bench.studies.sweep.run_plan import Driver, Phase, Report, Work, silent
from bench.studies.sweep.table import write_table
from bench.studies.trial.cases import RULES
from bench.studies.trial.setup import Setup, make_setup

ROBOTS = (
    *("five_bar", "delta", "three_rrr", "stewart", "palletiser"),
    *("wrist", "dualv", "orthoglide", "two_link"),
)
DURATION = 12.0
"""Duration of each recording, s."""

WORK = "work"
CASES, CLAIM, DESIGNS = "cases.jsonl", "cases.json", "designs"
TABLE = "trust.parquet"


@dataclass(frozen=True)
class TrustRequest:
    """A requested evaluation. setups: by robot; version: of the changelog; first: number of the first fresh case."""

    setups: Mapping[str, Setup]
    version: str
    first: int
    hours: float

    @property
    def cells(self) -> TrustCells:
        """All cells."""
        return TrustCells(self.setups, self.first)


class CaseJournal(Journal):
    """A journal with a tally of its rows."""

    def __init__(self, path: Path, cells: TrustCells) -> None:
        super().__init__(path, cells.size)
        self.tally = Tally(cells, self.rows())

    def save_rows(self, rows: Sequence[Row]) -> None:
        """Append rows, and count them."""
        super().save_rows(rows)
        for row in rows:
            self.tally.note(row)


def setups_of(robots: Sequence[str], duration: float = DURATION) -> dict[str, Setup]:
    """The trial setups of robots: built-in names, robot folders, or scenario files (with their robot).

    Keys: the built-in names, else the robots' names. duration: of each designed recording, s.
    """
    setups = {}
    for given in robots:
        if given.endswith(".toml") and "robot" in (content := read_with_bases(find_scenario(given))):
            setup = make_setup(str(content["robot"]), given, duration)
        else:
            setup = make_setup(given, duration=duration)
        setups[given if given in ROBOTS else setup.name] = setup
    return setups


def run_trust(
    request: TrustRequest,
    folder: Path,
    make_pool: Callable[[], AbstractContextManager[Pool]],
    report: Callable[[Tally, Budget], Report],
    phase: Phase = silent,
    work: Work | None = None,
    now: Callable[[], float] = time.monotonic,
) -> Path:
    """Run cases until the budget is spent; write all rows in `folder` to one table, and return its path.

    After any interruption another call continues; the rows of finished cases do not depend on the number of workers.
    Raises BenchError if the folder has cases of another commit or plan.
    """
    _claim(request, folder / WORK)
    phase("starting workers")
    with closing(CaseJournal(folder / WORK / CASES, request.cells)) as journal, make_pool() as pool:
        budget = Budget(request.hours, journal.tally.seconds, lambda: pool.slots, now)
        runs = runs_within(journal.tally, budget)
        driver = Driver(runs, journal, pool, work or trust_work(request.cells), folder / WORK / DESIGNS)
        driver.run(report(journal.tally, budget), phase)
    return write_rows(request, journal, folder)


def write_rows(request: TrustRequest, journal: Journal, folder: Path) -> Path:
    """Write the table of all rows, with the request as metadata; return its path."""
    planned = [
        {
            "robot": cell.robot,
            "question": cell.question.kind,
            "frozen": cell.frozen,
            "planned": len(cell.numbers),
        }
        for cell in request.cells.all
    ]
    metadata = {
        "trust": json.dumps(
            {"version": request.version, "first": request.first, "hours": request.hours, "cells": planned}
        )
    }
    write_table(journal, folder / TABLE, ("robot", "question", "set", "number"), metadata)
    return folder / TABLE


def _claim(request: TrustRequest, folder: Path) -> None:
    """Mark a folder as that of these cells at this commit. Raises BenchError if it is marked otherwise."""
    record = folder / CLAIM
    setups = [[setup.content, list(setup.effects)] for setup in request.setups.values()]
    content = {
        "commit": versions().commit,
        "first": request.first,
        "cells": digest([setups, RULES, [cell.numbers for cell in request.cells.all]]),
    }
    if not record.is_file():
        write_json_atomically(record, content)
        return
    there = json.loads(record.read_text(encoding="utf-8"))
    for name, value in content.items():
        if there.get(name) != value:
            raise BenchError(
                f"{folder}: holds cases of another evaluation ({name} {there.get(name)}, now {value}): "
                "delete it, or give another folder with -o DIR"
            )
