"""Cost of identification from long logs: two of 20 minutes at 1 kHz, 2.4 million samples.

Logs of any length are made of simulated movements of 20 s, which begin and end at rest.
`python -m bench.benchmarks.speed.long_log FOLDER` identifies from a dataset and prints processor seconds and peak
memory.
"""

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import click
import numpy as np

from bench.basics.errors import BenchError
from bench.benchmarks.measured.machines import dataset_of
from bench.benchmarks.measured_data import measured_data
from bench.benchmarks.speed.figures import SpeedFigure
from bench.benchmarks.speed.memory import peak_bytes
from bench.dataset.dataset import RecordingEntry, load_dataset, write_dataset_toml
from bench.dataset.recording import write_recording
from bench.identification.identify import fit
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.swapped_columns import swapped_columns
from bench.residuals.motor import compared
from bench.scenario.scenario import Scenario, load_scenario, payload_declared
from bench.truth.sensors import sense
from bench.truth.simulate import simulate

SECONDS_LIMIT = 8.0
MEMORY_LIMIT = 0.8  # GB
ARM, ARM_LIMIT = "tx40", 2.0  # s
DURATION = 1200.0  # s, of each of two logs
PARTS = 3  # movements simulated for each recording, which repeats them in turn
PART = 20.0  # s
FRICTION = {"emps": 10.0, "five_bar": 0.2, "three_rrr": 0.3, "stewart": 8.0, "two_link": 0.3}
"""Dry friction [N*m or N] that no model contains; it makes the band of the fit wide, as on a real machine."""


def write_long_dataset(folder: Path, duration: float, robot: str = "five_bar") -> Path:
    """Write a dataset of a robot with dry friction: two Parquet logs of `duration` s, unloaded and loaded.

    Movements repeat, noise does not. Returns the folder.
    """
    scenario, payload = _scenario(robot)
    simulation = simulate(scenario, threads=1)
    rate = 1.0 / scenario.log_period
    samples = round(duration * rate)
    entries = []
    folder.mkdir(parents=True, exist_ok=True)
    for name, carried in (("unloaded", None), ("loaded", payload)):
        parts = [recording for recording in simulation.recordings if recording.table.payload == carried]
        count = -(-samples // len(parts[0].position))
        position = np.concatenate([_closed(parts[k % PARTS].position) for k in range(count)])[:samples]
        current = np.concatenate([parts[k % PARTS].current for k in range(count)])[:samples]
        log = sense(
            scenario.settings.sensors,
            scenario.robot.joints,
            scenario.settings.seed,
            name,
            np.arange(samples) / rate,
            position,
            current,
        )
        file = f"{name}.parquet"
        write_recording(folder / file, log.time, log.position, log.current, scenario.robot.joints)
        entries.append(RecordingEntry(file, "identify", carried))
    declared = payload_declared(payload, scenario.settings.payloads[payload])
    write_dataset_toml(folder, robot, entries, [declared])
    return folder


def _closed(position: np.ndarray) -> np.ndarray:
    """Positions (N, n) that end where they begin; the difference, due to friction, is spread over all samples."""
    return position - np.linspace(0.0, 1.0, len(position))[:, None] * (position[-1] - position[0])


def _scenario(robot: str) -> tuple[Scenario, str]:
    """A scenario with `PARTS` movements of the robot without, and as many with its payload; the payload's name."""
    payload = next(iter(load_scenario(robot).settings.payloads))
    recordings = [
        {"name": f"{name}_{k}", "use": "identify", "design": {"seed": 2 * k + i}, **carried}
        for k in range(PARTS)
        for i, (name, carried) in enumerate((("free", {}), ("loaded", {"payload": payload})))
    ]
    hidden = [{"effect": "coulomb_friction", "Fc": FRICTION[robot]}]
    design = {"optimise": False, "duration": PART}
    return load_scenario(robot, {"recordings": recordings, "hidden": hidden, "design": design}), payload


def long_log_figures() -> list[SpeedFigure]:
    """Processor time and peak memory of a process that identifies from two logs of 20 minutes and, if its data are
    available, time for a measured arm of six axes, 9 s at 5 kHz. Raises BenchError if the process fails.
    """
    with TemporaryDirectory() as folder:
        data = write_long_dataset(Path(folder) / "dataset", DURATION)
        program = [sys.executable, "-m", "bench.benchmarks.speed.long_log", str(data)]
        done = subprocess.run(program, capture_output=True, text=True, check=False)
        if done.returncode:
            raise BenchError(f"the long logs cannot be identified: {done.stderr}")
        cost = json.loads(done.stdout)
        name = "identify a five-bar, two logs of 20 minutes at 1 kHz"
        figures = [
            SpeedFigure(name, cost["seconds"], "s", SECONDS_LIMIT),
            SpeedFigure(f"{name}, memory", cost["gigabytes"], "GB", MEMORY_LIMIT),
        ]
        if (measured_data() / ARM).is_dir():
            seconds = identification_seconds(dataset_of(ARM, measured_data(), Path(folder)))
            figures.append(SpeedFigure("identify six axes, 45,000 samples at 5 kHz", seconds, "s", ARM_LIMIT))
    return figures


def identification_seconds(folder: Path) -> float:
    """Processor seconds of the work of `bench identify`: reading, fitting, and checks of columns and errors."""
    start = process_time()
    dataset = load_dataset(folder)
    problem = problem_of(dataset)
    prepared = prepare(problem)
    result = fit(prepared)
    swapped_columns(problem, result, prepared)
    compared(dataset.robot, dataset.recordings, result.recordings, result.settings)
    return process_time() - start


def main() -> None:
    """Identify, and print the cost as JSON, without the time of start-up."""
    cost = {"seconds": identification_seconds(Path(sys.argv[1])), "gigabytes": peak_bytes() / 1e9}
    click.echo(json.dumps(cost))


if __name__ == "__main__":
    main()
