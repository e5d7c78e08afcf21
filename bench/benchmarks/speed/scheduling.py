"""Overhead of a sweep for each run: planning, scheduling, transport and journal.

Ten thousand runs without work, one task each, then a fifth more during which memory is observed, pass through the
processes of this machine, and through a Dask scheduler with 64 workers in one other process.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically
from bench.basics.versions import versions
from bench.benchmarks.speed.figures import SpeedFigure
from bench.benchmarks.speed.stand_in import NO_WORK
from bench.studies.sweep.dask_pool import DaskPool
from bench.studies.sweep.journal import Journal
from bench.studies.sweep.plan import make_plan
from bench.studies.sweep.pool import LocalPool, Pool
from bench.studies.sweep.run_sweep import JOURNAL, run_sweep
from bench.studies.sweep.sweep_file import load_sweep

RUNS, LOCAL_WORKERS, DASK_WORKERS = 10_000, 2, 64
COST_LIMIT = 2.0  # ms of the driver's processor time per run
GROWTH_LIMIT = 2.0  # MB, over the additional runs
MORE = 0.2  # share of additional runs, for the memory: bounded buffers are full by then, in Dask 36 MB over 9,000 runs
SILENCED = {"DASK_LOGGING__DISTRIBUTED": "critical"}  # messages of leaving workers are of no interest
RESULT = Path("results/speed/scheduling.json")
SWEEP = """
base = "five_bar"
seeds = {runs}
[axes]
"gains.error.left" = {{ draw = "uniform", from = -0.15, to = 0.15 }}
"""


@dataclass(frozen=True)
class Scheduling:
    """Figures of one pool. driver, scheduler: their processor time per run, ms (the local pool has no scheduler); rate:
    runs per second after the first; growth: memory that the driver gained over the additional runs, MB; row: bytes per
    run in the journal.
    """

    pool: str
    workers: int
    runs: int
    driver: float
    scheduler: float
    rate: float
    growth: float
    row: float


@dataclass
class _Watch:
    """Records time whenever runs are finished and, after the first `runs`, memory."""

    runs: int
    first: tuple[int, float] | None = None
    last: tuple[int, float] = (0, 0.0)
    memory: list[float] = field(default_factory=list)

    def __call__(self, journal: Journal) -> None:
        if journal.count and journal.count != self.last[0]:
            self.last = journal.count, time.perf_counter()
            self.first = self.first or self.last
            if journal.count >= self.runs:
                self.memory.append(resident())

    @property
    def rate(self) -> float:
        """Runs per second. Raises BenchError with too few runs."""
        if self.first is None or self.last[0] == self.first[0]:
            raise BenchError("too few runs to measure")
        return (self.last[0] - self.first[0]) / (self.last[1] - self.first[1])


def resident() -> float:
    """Resident memory of this process, MB (Linux)."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def _sent(runs: int) -> int:
    """The number of runs, with the additional ones for the memory."""
    return round((1.0 + MORE) * runs)


def measure(name: str, workers: int, make_pool: Callable[[], Pool], runs: int = RUNS) -> Scheduling:
    """Send `runs` runs without work through a pool, then the additional ones. Raises BenchError if runs fail."""
    sent = _sent(runs)
    with tempfile.TemporaryDirectory(prefix="bench-speed-") as folder:
        file, out, watch = Path(folder) / "sweep.toml", Path(folder) / "out", _Watch(runs)
        file.write_text(SWEEP.format(runs=sent), encoding="utf-8")
        plan = make_plan(load_sweep(file))
        start = time.process_time()
        finished = run_sweep(plan, out, make_pool, NO_WORK, watch)
        seconds = time.process_time() - start
        if finished.failed or finished.runs != sent:
            raise BenchError(f"scheduling: {finished.failed} of {finished.runs} runs failed")
        row = (out / JOURNAL).stat().st_size / sent
    growth = watch.memory[-1] - watch.memory[0]
    return Scheduling(name, workers, runs, 1e3 * seconds / sent, 0.0, watch.rate, growth, row)


class _Process:
    """A scheduler or its workers in a separate process. Raises BenchError if it does not start."""

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "bench.benchmarks.speed.stand_in", *arguments]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=os.environ | SILENCED
        )
        assert self._process.stdout is not None
        self.address = self._process.stdout.readline().strip()
        if not self.address:
            self.end()
            raise BenchError("the Dask scheduler to be measured does not start; what it says stands above")

    def end(self) -> float:
        """End the process; return its processor time, s."""
        said, _ = self._process.communicate()  # closes its input, which ends it
        return float(said or 0.0)


def measure_dask() -> Scheduling:
    """Measure Dask's pool, with its scheduler in one process and its workers in another."""
    scheduler = _Process()
    try:
        hands = _Process(scheduler.address, str(DASK_WORKERS))
        try:
            measured = measure("dask", DASK_WORKERS, lambda: DaskPool(scheduler.address))
        finally:
            hands.end()
    finally:
        seconds = scheduler.end()
    return replace(measured, scheduler=1e3 * seconds / _sent(RUNS))


def measure_all() -> list[Scheduling]:
    """Measure both pools."""
    return [measure("local", LOCAL_WORKERS, lambda: LocalPool(LOCAL_WORKERS)), measure_dask()]


def scheduling_figures() -> list[SpeedFigure]:
    """Cost and memory of both pools; also writes their numbers."""
    measured = measure_all()
    write_json_atomically(RESULT, [{**asdict(scheduling), **versions().columns()} for scheduling in measured])
    return [figure for scheduling in measured for figure in figures_of(scheduling)]


def figures_of(scheduling: Scheduling) -> list[SpeedFigure]:
    """The limited figures of a pool, and its rate."""
    name = f"{scheduling.runs} runs without work, {scheduling.pool}, {scheduling.workers} workers"
    return [
        SpeedFigure(f"{name}: driver's time a run", scheduling.driver, "ms", COST_LIMIT),
        SpeedFigure(f"{name}: memory gained", scheduling.growth, "MB", GROWTH_LIMIT),
        SpeedFigure(f"{name}: runs a second", scheduling.rate, "/s"),
    ]
