"""A cheap stand-in for the work of a sweep: rows from random numbers, and accidents on request.

`main` runs a whole sweep in a process of its own, to be killed.
"""

import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from bench.basics.errors import BenchError
from bench.studies.sweep.plan import make_plan
from bench.studies.sweep.pool import LocalPool, Outcome, Pool, attempt
from bench.studies.sweep.run_sweep import run_sweep
from bench.studies.sweep.sweep_file import load_sweep
from bench.truth.streams import stream

SWEEP = """
base = "five_bar"
seeds = {seeds}
[axes]
"payloads.disc.mass" = [0.2, 0.4, 0.8]
"sensors.current_noise_ratio" = {{ from = 0.001, to = 0.1, count = 3, spacing = "log" }}
method = ["ls", "current"]
"""


@dataclass(frozen=True)
class Accidents:
    """Numbers of runs that go wrong: refused, broken by a bug, or killing their worker (once or always)."""

    refused: tuple[int, ...] = ()
    broken: tuple[int, ...] = ()
    killed: tuple[int, ...] = ()
    killed_once: tuple[int, ...] = ()
    marks: Path | None = None
    motionless: bool = False


NONE = Accidents()


@dataclass(frozen=True)
class Motion:
    """Stands for a simulation."""

    name: str
    fails: bool
    log: Path | None

    def __call__(self, _):
        if self.log is not None:
            with self.log.open("a") as file:
                file.write(f"{self.name}\n")
        if self.fails:
            raise BenchError("the motion is impossible")
        return self.name


@dataclass(frozen=True)
class Design:
    """Stands for a design of trajectories."""

    def __call__(self, _):
        return {}


@dataclass(frozen=True)
class Runs:
    """Stands for identifications; `shared` must be the motion of the runs, or None."""

    runs: tuple
    accidents: Accidents
    pause: float

    def __call__(self, shared):
        assert shared in (None, self.runs[0].motion)
        time.sleep(self.pause)
        return [self._row(run) for run in self.runs]

    def _row(self, run):
        numbers, accidents = run.number, self.accidents
        if numbers in accidents.killed:
            os.kill(os.getpid(), signal.SIGKILL)
        if numbers in accidents.killed_once:
            mark = accidents.marks / f"{numbers}"
            if not mark.exists():
                mark.touch()
                os.kill(os.getpid(), signal.SIGKILL)
        if numbers in accidents.broken:
            raise ZeroDivisionError("a bug")
        if numbers in accidents.refused:
            return failed(run, "nothing moves")
        noise = stream(run.seed, run.motion, str(run.axes)).standard_normal()
        return {
            "run": numbers,
            "status": "ok",
            "reason": None,
            "seed": run.seed,
            **run.axes,
            "gain_error": abs(noise) / 3,
        }


def failed(run, reason):
    return {"run": run.number, "status": "failed", "reason": reason, "seed": run.seed, **run.axes}


@dataclass(frozen=True)
class StandIn:
    """The work of a sweep, without any work."""

    accidents: Accidents = NONE
    pause: float = 0.0
    log: Path | None = None

    def design(self, run):
        return Design()

    def motion(self, run, trajectories):
        return Motion(run.motion, self.accidents.motionless, self.log)

    def runs(self, runs, trajectories):
        return Runs(runs, self.accidents, self.pause)

    def failed(self, run, reason):
        return failed(run, reason)


class Inline(Pool):
    """A pool that runs tasks in this process, first come, first served."""

    slots = 1

    def __init__(self):
        self.tasks = []

    def submit(self, key, task, shared=None):
        self.tasks.append((key, task, shared))

    def outcomes(self):
        tasks, self.tasks = self.tasks, []
        return [Outcome(key, *attempt(task, shared and shared.value)) for key, task, shared in tasks]

    def close(self):
        self.tasks.clear()


def plan_of(folder, text=None, seeds=5):
    """The plan of a sweep file in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "sweep.toml"
    path.write_text(SWEEP.format(seeds=seeds) if text is None else text)
    return make_plan(load_sweep(path))


def run(plan, folder, pool=Inline, work=None, report=lambda journal: None, **options):
    return run_sweep(plan, folder, pool, work or StandIn(), report, **options)


def main():
    """A sweep with two workers; arguments: file, folder, seconds that every task waits.

    In the file memory.txt beside it, if there is one: a line for every thousand runs, their number and how many
    kilobytes of memory the process has.
    """
    file, target, pause = sys.argv[1:]
    memory = Path(file).with_name("memory.txt")
    said = [0]

    def report(journal):
        if memory.exists() and journal.count >= said[0] + 1000:
            said[0] = journal.count
            with memory.open("a") as log:
                log.write(f"{journal.count} {resident()}\n")

    plan = make_plan(load_sweep(file))
    run(plan, Path(target), lambda: LocalPool(2), StandIn(pause=float(pause)), report)


def resident():
    """Kilobytes of memory that this process has (Linux)."""
    status = Path("/proc/self/status").read_text()
    return next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS"))
