"""Run a sweep and write its table."""

import json
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically, write_text_atomically
from bench.studies.sweep.journal import Journal
from bench.studies.sweep.plan import Plan, digest
from bench.studies.sweep.pool import Pool
from bench.studies.sweep.run_plan import Driver, Phase, Report, Work, silent
from bench.studies.sweep.table import write_table

TABLE, JOURNAL, RECORD, DESIGNS, FILE = "runs.parquet", "runs.jsonl", "sweep.json", "designs", "sweep.toml"


@dataclass(frozen=True)
class Finished:
    """The result of a sweep."""

    folder: Path
    table: Path
    runs: int
    failed: int
    kept: int = 0
    """Number of runs kept from before."""


def run_sweep(
    plan: Plan,
    folder: Path,
    make_pool: Callable[[], AbstractContextManager[Pool]],
    work: Work,
    report: Report,
    *,
    retry_failed: bool = False,
    designs: Path | None = None,
    phase: Phase = silent,
    resumed: Callable[[int], None] = lambda _kept: None,
) -> Finished:
    """Run the missing runs and write the table. designs: folder of trajectories, by default that of the sweep.

    report: called whenever runs are finished; phase: called with the phase until then; resumed: called before the
    start with the number of runs kept from before. Started again on the same folder after any interruption, it
    continues, and the table is the same to the last bit.
    Raises BenchError if the folder belongs to another sweep, or cannot be written.
    """
    with written(folder):
        _claim(plan, folder)
        with closing(Journal(folder / JOURNAL, plan.size)) as journal:
            report(journal)
            kept = journal.count - (len(journal.failed) if retry_failed else 0)
            if kept:
                resumed(kept)
            if journal.count < plan.size or (retry_failed and journal.failed):
                phase("starting workers")
                again = frozenset(journal.failed) if retry_failed else frozenset()
                tasks = plan.tasks(lambda number: number in journal and number not in again)
                with make_pool() as pool:
                    Driver(tasks, journal, pool, work, designs or folder / DESIGNS).run(report, phase)
            metadata = {"sweep": plan.sweep.name, "description": plan.sweep.table.description}
            write_table(journal, folder / TABLE, plan.axis_names, metadata)
            return Finished(folder, folder / TABLE, journal.count, len(journal.failed), kept)


@contextmanager
def written(folder: Path) -> Iterator[None]:
    """Turn errors of writing into the folder of a sweep, such as a full disk, into a BenchError of one line."""
    try:
        yield
    except OSError as error:
        why = error.strerror or str(error)
        raise BenchError(f"{folder}: {why}; finished runs are kept, and the same command resumes") from error


def _claim(plan: Plan, folder: Path) -> None:
    """Mark a folder as belonging to this sweep; BenchError if it has other content."""
    record = folder / RECORD
    content = {
        "sweep": plan.sweep.name,
        "runs": plan.size,
        "axes": list(plan.axis_names),
        "digest": plan_digest(plan),
    }
    if record.is_file():
        if json.loads(record.read_text(encoding="utf-8")) != content:
            raise BenchError(
                f"{folder}: holds another sweep, or an older version of this one: give another folder"
            )
        return
    if folder.exists() and not folder.is_dir():
        raise BenchError(f"{folder}: is not a folder: give another one")
    if folder.exists() and any(folder.iterdir()):
        raise BenchError(f"{folder}: already exists and holds no sweep: give another folder")
    write_text_atomically(folder / FILE, plan.sweep.path.read_text(encoding="utf-8"))
    write_json_atomically(record, content)


def plan_digest(plan: Plan) -> str:
    """Digest of everything that the runs depend on: the sweep's file and its scenarios."""
    runs = (plan.run(0), plan.run(plan.size - 1))
    table = plan.sweep.table.model_dump(mode="json", exclude={"description", "show", "plots"})
    return digest([table, [[run.content, run.axes] for run in runs]])
