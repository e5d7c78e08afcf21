"""Cost of a sweep: two hundred five-bars, each simulated and identified from two recordings of 10 s."""

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from bench.basics.errors import BenchError
from bench.benchmarks.speed.figures import SpeedFigure
from bench.benchmarks.speed.main_job import plain_rollout
from bench.excitation.scenario import designer
from bench.scenario.scenario import resolve_trajectories, scenario_from_dict
from bench.studies.sweep.plan import make_plan
from bench.studies.sweep.pool import LocalPool
from bench.studies.sweep.run_sweep import RECORD, run_sweep
from bench.studies.sweep.sweep_file import load_sweep
from bench.studies.sweep.work import identification_work
from bench.truth.simulate import simulate

RUNS, FEWER = 200, 60
SECONDS_LIMIT, GAIN_LIMIT, START_LIMIT = 38.0, 1.8, 3.0
STEPPING = 28.0  # s of MuJoCo's time steps alone on the machine for which the limits in seconds were set
WORKERS, STEPPED = 2, 8  # STEPPED: runs whose time steps alone are measured; the others are as long
SWEEP = """
base = "five_bar"
seeds = {runs}
[scenario]
recordings = [
    {{ name = "unloaded", use = "identify", design = {{ seed = 1, duration = 10.0 }} }},
    {{ name = "loaded", use = "identify", payload = "disc", design = {{ seed = 2, duration = 10.0 }} }},
]
[axes]
"gains.error.left" = {{ draw = "uniform", from = -0.15, to = 0.15 }}
"gains.error.right" = {{ draw = "uniform", from = -0.15, to = 0.15 }}
"""


def sweep_figures() -> list[SpeedFigure]:
    """Seconds of 200 runs with two workers, and of their time steps alone, a measure of the machine's speed; the gain
    from the second worker; and seconds until the first run.
    """
    with tempfile.TemporaryDirectory(prefix="bench-speed-") as folder:
        file = Path(folder) / "sweep.toml"
        file.write_text(SWEEP.format(runs=RUNS), encoding="utf-8")
        start = _start_seconds(file, Path(folder) / "started")
        seconds, together = _timed(file, Path(folder) / "two", WORKERS)
        file.write_text(SWEEP.format(runs=FEWER), encoding="utf-8")
        alone = _timed(file, Path(folder) / "one", 1)[1]
        stepping = _stepping_seconds(file)
    return [
        SpeedFigure(f"sweep: {RUNS} five-bar runs, two workers", seconds, "s", SECONDS_LIMIT),
        SpeedFigure("sweep: MuJoCo's stepping of these runs alone", stepping, "s"),
        SpeedFigure("sweep: over the stepping alone", seconds / stepping, "×", SECONDS_LIMIT / STEPPING),
        SpeedFigure(
            "sweep: runs a second, two workers over one", together / alone, "×", GAIN_LIMIT, at_least=True
        ),
        SpeedFigure("sweep: from the command to the first run", start, "s", START_LIMIT),
    ]


def _timed(file: Path, folder: Path, workers: int) -> tuple[float, float]:
    """Seconds of a whole sweep, and runs per second after the first."""
    plan = make_plan(load_sweep(file))
    times: list[tuple[int, float]] = []

    report: Callable[..., None] = lambda journal: times.append((journal.count, time.perf_counter()))  # noqa: E731
    start = time.perf_counter()
    run_sweep(plan, folder, lambda: LocalPool(workers), identification_work(plan.sweep), report)
    first = next(pair for pair in times if pair[0])
    return time.perf_counter() - start, (times[-1][0] - first[0]) / (times[-1][1] - first[1])


def _stepping_seconds(file: Path) -> float:
    """Seconds of all runs' time steps alone, by mujoco.rollout on as many threads as there are workers."""
    scenario = scenario_from_dict(make_plan(load_sweep(file)).run(0).content, "five_bar")
    simulation = simulate(scenario, resolve_trajectories(scenario, designer))
    return plain_rollout(simulation, copies=STEPPED, threads=WORKERS) * RUNS / STEPPED


def _start_seconds(file: Path, folder: Path) -> float:
    """Seconds from the command until the sweep has been checked and its first task is handed out."""
    start = time.perf_counter()
    command = [sys.executable, "-m", "bench", "sweep", str(file), "-o", str(folder), "--workers", "2"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        while not (folder / RECORD).exists():
            if process.poll() is not None:
                raise BenchError(f"the sweep to be timed does not start: {process.communicate()[1].strip()}")
            time.sleep(0.01)
        seconds = time.perf_counter() - start
        process.terminate()
        process.communicate()  # its last messages are of no interest
    return seconds
