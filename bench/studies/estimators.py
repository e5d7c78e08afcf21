"""The estimators side by side: `python -m bench.studies.estimators -o results/estimators`.

Bias, spread, coverage and computing time of each estimator, for different robots, noise of currents and encoders,
unsuitable filters, bad seconds in the currents, and controllers. Seeds differ in the noise of the currents and in the
positions of the encoder steps. The number of workers does not affect the results.
"""

import json
import os
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import click
import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically, write_text_atomically
from bench.basics.plain_data import finite
from bench.basics.sentence import in_percent
from bench.basics.threads import on_one_thread
from bench.basics.versions import versions
from bench.dataset.dataset import Dataset
from bench.excitation.scenario import designer
from bench.identification.estimators import ESTIMATORS
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import Scenario, load_scenario, resolve_trajectories
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.dataset import as_dataset
from bench.truth.machine import true_gains
from bench.truth.resense import sense_again
from bench.truth.simulate import Simulation, simulate

ROBOTS = ("two_link", "five_bar", "delta")
DURATION = 10.0  # s: each of two recordings, one with the payload
BAD = ("stuck", "offset", "noisy")  # kinds of bad seconds


@dataclass(frozen=True)
class Condition:
    """Differences from the first case: sensors and controller of the scenario, filters of the fit, number of bad
    seconds in each recording (each at one motor), and the simulation's step, s.
    """

    name: str
    sensors: Mapping[str, float] = field(default_factory=dict)
    controller: Mapping[str, float] = field(default_factory=dict)
    filters: Mapping[str, float] = field(default_factory=dict)
    bad_seconds: int = 0
    step: float | None = None


CASES = (
    Condition("20 bits, 1 % noise of the currents"),
    Condition("0.1 % noise of the currents", {"current_noise_ratio": 0.001}),
    Condition("10 % noise of the currents", {"current_noise_ratio": 0.1}),
    Condition("16-bit encoders", {"encoder_bits": 16}),
    Condition("14-bit encoders", {"encoder_bits": 14}),
    Condition(
        "filter too wide: 160 Hz, one sample in 4", {}, {}, {"position_cutoff": 160.0, "decimation": 4}
    ),
    Condition(
        "the same, 14-bit encoders", {"encoder_bits": 14}, {}, {"position_cutoff": 160.0, "decimation": 4}
    ),
    Condition("filter too narrow: 5 Hz", {}, {}, {"position_cutoff": 5.0}),
    Condition("one bad second in ten", bad_seconds=1),
    Condition("two bad seconds in ten", bad_seconds=2),
    Condition("soft controller: 5 Hz", {}, {"natural_frequency": 5.0, "tracking_limit": 1.0}),
    Condition("stiff controller: 20 Hz", {}, {"natural_frequency": 20.0}),
    Condition("26-bit encoders", {"encoder_bits": 26}),
    Condition("the same, simulated in steps of 0.1 ms", {"encoder_bits": 26}, step=1e-4),
)


@dataclass(frozen=True)
class EstimatorRow:
    """One estimator on one robot in one case; errors are relative to the true gains, of the joint with the largest.

    bias: mean error; spread: standard deviation of the error; error: median over seeds of the largest error of a
    gain; within: share of 95 % intervals that contain the truth; seconds: median processor time of the fit. failed:
    number of seeds without a result; reason: of the first of them.
    """

    robot: str
    case: str
    method: str
    seeds: int
    bias: float
    spread: float
    error: float
    within: float
    seconds: float
    failed: int = 0
    reason: str = ""


def changes(robot: str, case: Condition, seed: int) -> dict[str, Any]:
    """Changes to the robot's built-in scenario for a case: two recordings, declared control law."""
    step = {} if case.step is None else {"step": case.step}
    return step | {
        "seed": seed,
        "sensors": dict(case.sensors),
        "controller": {"declared": True, **case.controller},
        "recordings": two_recordings(robot, DURATION),
    }


def two_recordings(robot: str, duration: float) -> list[dict[str, Any]]:
    """Recordings with designed motions of `duration` s, without and with the payload of the robot's scenario."""
    payload = next(iter(load_scenario(robot).settings.payloads))
    design = {"optimise": True, "duration": duration, "ramp": 0.5}
    return [
        {"name": "unloaded", "use": "identify", "design": {"seed": 1, **design}},
        {"name": "loaded", "use": "identify", "payload": payload, "design": {"seed": 2, **design}},
    ]


def with_bad_seconds(dataset: Dataset, count: int, seed: int) -> Dataset:
    """The dataset with `count` bad seconds in each recording, each at one motor: current stuck, offset by twice its
    standard deviation, or with noise of that size.
    """
    random = np.random.default_rng([seed, count])
    recordings = []
    for recording in dataset.recordings:
        current, second = recording.current.copy(), round(recording.rate)
        for start in random.choice(len(current) // second, count, replace=False) * second:
            part, motor = slice(start, start + second), int(random.integers(current.shape[1]))
            size = 2.0 * float(recording.current[:, motor].std())
            kind = BAD[int(random.integers(len(BAD)))]
            if kind == "stuck":
                current[part, motor] = current[start, motor]
            elif kind == "offset":
                current[part, motor] += size
            else:
                current[part, motor] += size * random.standard_normal(second)
        recordings.append(replace(recording, current=current))
    return replace(dataset, recordings=tuple(recordings))


@lru_cache(maxsize=len(ROBOTS))
def _trajectories(robot: str) -> Mapping[str, FourierTrajectory]:
    return resolve_trajectories(_scenario(robot, CASES[0], 1), designer)


def _scenario(robot: str, case: Condition, seed: int) -> Scenario:
    return load_scenario(robot, changes(robot, case, seed))


@lru_cache(maxsize=2)
def _simulated(robot: str, controller: tuple[tuple[str, float], ...], step: float | None) -> Simulation:
    case = Condition("", controller=dict(controller), step=step)
    return simulate(_scenario(robot, case, 1), _trajectories(robot), threads=1)


def steps_at(robot: str, seed: int) -> np.ndarray:
    """Random positions (n,) of the encoder steps, rad or m, as on a real machine."""
    random = np.random.default_rng([seed, len(ROBOTS)])
    return random.uniform(0.0, 0.1, len(load_scenario(robot).robot.driven))


@on_one_thread
def rows_of(robot: str, case: Condition, methods: Sequence[str], seeds: int) -> list[EstimatorRow]:
    """Every method on the same data of a robot in a case, for seeds 1 to `seeds`."""
    simulation = _simulated(robot, tuple(case.controller.items()), case.step)
    truth = true_gains(simulation.scenario)
    runs: dict[str, list[tuple[np.ndarray, np.ndarray, float]]] = {method: [] for method in methods}
    reasons: dict[str, list[str]] = {method: [] for method in methods}
    for seed in range(1, seeds + 1):
        dataset = as_dataset(sense_again(simulation, _scenario(robot, case, seed), steps_at(robot, seed)))
        prepared = prepare(
            problem_of(with_bad_seconds(dataset, case.bad_seconds, seed), (), filters=dict(case.filters))
        )
        for method in methods:
            start = time.process_time()
            try:
                gains = identify(prepared, method).drive_gains.values()
            except BenchError as error:
                reasons[method].append(str(error))
                continue
            seconds = time.process_time() - start
            values, stds = (np.array([getattr(gain, key) for gain in gains]) for key in ("value", "std"))
            runs[method].append((values / truth - 1.0, stds / truth, seconds))
    return [_row(robot, case, method, runs[method], reasons[method]) for method in methods]


def _row(
    robot: str,
    case: Condition,
    method: str,
    runs: Sequence[tuple[np.ndarray, np.ndarray, float]],
    reasons: Sequence[str],
) -> EstimatorRow:
    failed, reason = len(reasons), reasons[0] if reasons else ""
    if not runs:
        nan = float("nan")
        return EstimatorRow(robot, case.name, method, 0, nan, nan, nan, nan, nan, failed, reason)
    errors, stds = (np.array([pair[k] for pair in runs]) for k in (0, 1))
    return EstimatorRow(
        robot,
        case.name,
        method,
        len(runs),
        bias=float(np.abs(errors.mean(axis=0)).max()),
        spread=float(errors.std(axis=0, ddof=1).max()) if len(runs) > 1 else float("nan"),
        error=float(np.median(np.abs(errors).max(axis=1))),
        within=float((np.abs(errors) <= WITHIN_95 * stds).mean()),
        seconds=float(np.median([pair[2] for pair in runs])),
        failed=failed,
        reason=reason,
    )


def markdown(rows: Sequence[EstimatorRow]) -> str:
    """A table for each robot, with a row for each case and estimator."""
    text = ["# Estimators", "", EXPLANATION, ""]
    for robot in dict.fromkeys(row.robot for row in rows):
        text += [f"## {robot}", "", "| case | estimator | bias | spread | largest error | within | seconds |"]
        text.append("|---|---|---:|---:|---:|---:|---:|")
        before = ""
        for row in (each for each in rows if each.robot == robot):
            shares = [in_percent(x, 2) for x in (row.bias, row.spread, row.error)]
            cells = [*shares, f"{100.0 * row.within:.0f} %", f"{row.seconds:.2g}"]
            name = row.case if row.case != before else ""
            before = row.case
            failed = f" ({row.failed} refused)" if row.failed else ""
            text.append("| " + " | ".join([name, row.method + failed, *cells]) + " |")
        text.append("")
    return "\n".join(text)


EXPLANATION = (
    "Errors of the drive gains, relative to the true ones, of the joint where they are largest: `bias`, their mean "
    "over the seeds, each with different current noise and encoder offsets; `spread`, their "
    "standard deviation; `largest error`, the median over the seeds of the worst gain. `within`: 95 % intervals that "
    "contain the truth. `seconds`: processor time of the fit alone, from equations to estimates. Two recordings of "
    f"{DURATION:g} s at 1 kHz, one with the payload; each case states its difference from the first. `oe` knows the "
    "control law. Written by `python -m bench.studies.estimators`."
)


@click.command()
@click.argument("robots", nargs=-1)
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="Folder of the tables.")
@click.option("--seeds", type=click.IntRange(min=1), default=20, show_default=True, help="Of the noise.")
@click.option("--workers", type=click.IntRange(min=1), default=os.cpu_count() or 1, show_default=True)
def main(robots: tuple[str, ...], output: Path, seeds: int, workers: int) -> None:
    """Write the rows of each robot as JSON, and those of all robots in the folder as a table in Markdown."""
    for robot in robots or ROBOTS:
        with ProcessPoolExecutor(workers) as pool:
            futures = [pool.submit(rows_of, robot, case, sorted(ESTIMATORS), seeds) for case in CASES]
            rows = []
            for case, future in zip(CASES, futures, strict=True):
                rows += future.result()
                click.echo(f"{robot}: {case.name}")
        content = {"seeds": seeds, "duration": DURATION, "rows": [asdict(row) for row in rows]}
        write_json_atomically(output / f"{robot}.json", finite(content | versions().columns()))
    write_text_atomically(output / "estimators.md", markdown(kept_rows(output)))


def kept_rows(folder: Path) -> list[EstimatorRow]:
    """The rows of all robots in a folder, built-in ones first."""
    files = sorted(
        folder.glob("*.json"), key=lambda path: (*(path.stem != robot for robot in ROBOTS), path.stem)
    )
    read = [json.loads(file.read_text(encoding="utf-8"))["rows"] for file in files]
    every: list[dict[str, Any]] = [row for rows in read for row in rows]
    return [_kept(row) for row in every]


def _kept(row: Mapping[str, Any]) -> EstimatorRow:
    values: dict[str, Any] = {key: float("nan") if value is None else value for key, value in row.items()}
    return EstimatorRow(**values)


if __name__ == "__main__":
    main()
