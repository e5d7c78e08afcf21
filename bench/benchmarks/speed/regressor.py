"""Cost of the projected regressor, closures and accelerations included, compared with Pinocchio's tree regressor.

Run as `python -m bench.benchmarks.speed.regressor`. Both go over the same tree and the same samples, alternately, so
that what else the machine does falls out of their ratio.
"""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
import pinocchio as pin
from rich.table import Table

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.basics.versions import versions
from bench.dataset.robot import load_robot
from bench.model.base import base_parameters
from bench.model.follow import build_tree
from bench.model.geometry import Geometry, read_geometry
from bench.model.motion import Motion, motion_of
from bench.model.regressor import projected_regressor
from bench.model.states import active_ranges
from bench.signals.processing import estimate_motion
from bench.signals.settings import FilterSettings
from bench.studies.sweep.print_summary import table_console

LIMITS = {"five_bar": 6.0, "delta": 4.0}  # times Pinocchio's loop
RATE, DURATION = 1000.0, 20.0  # Hz, s
ENCODER = 2.0 * np.pi / 2**20  # rad
HARMONICS, BASE_FREQUENCY = 5, 0.2  # Hz
SETTINGS = FilterSettings(position_cutoff=30.0, decimation=10, border=(200, 200))
SEED = 20120603
RESULT = Path("results/speed/regressor.json")


@dataclass(frozen=True)
class RegressorSpeed:
    """Medians over the repeats: microseconds a sample, and how many times Pinocchio's loop both parts cost."""

    robot: str
    samples: int
    columns: int
    closures: float
    regressor: float
    pinocchio: float
    ratio: float


def measure(robot: str, repeats: int = 9) -> RegressorSpeed:
    """Time one robot on a movement of 20 s at 1 kHz, as an encoder of 20 bits sees it."""
    geometry = read_geometry(load_robot(robot))
    columns = base_parameters(geometry).columns
    track, motion = _movement(geometry)
    tree = build_tree(geometry)
    data, regressor = tree.createData(), pin.computeJointTorqueRegressor
    times = np.empty((repeats, 3))
    for repeat in range(repeats):
        start = perf_counter()
        motion = motion_of(geometry, *track)
        closed = perf_counter()
        projected_regressor(geometry, motion, columns)
        projected = perf_counter()
        for q, v, a in zip(motion.q, motion.v, motion.a, strict=True):
            regressor(tree, data, q, v, a)
        times[repeat] = closed - start, projected - closed, perf_counter() - projected
    samples = len(motion.time)
    closures, ours, pinocchio = np.median(times, axis=0) / samples * 1e6
    ratio = float(np.median((times[:, 0] + times[:, 1]) / times[:, 2]))
    return RegressorSpeed(robot, samples, len(columns), closures, ours, pinocchio, ratio)


def _movement(geometry: Geometry) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], Motion]:
    """A Fourier series within the joint ranges, made smaller until all of it can be reached."""
    random = np.random.default_rng(SEED)
    low, high = active_ranges(geometry)
    home = geometry.home[geometry.active_configuration]
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    angle = 2.0 * np.pi * BASE_FREQUENCY * np.outer(time, np.arange(1, HARMONICS + 1))
    sines, cosines = random.normal(size=(2, HARMONICS, len(home)))
    series = np.sin(angle) @ sines + np.cos(angle) @ cosines
    series -= series[0]
    series /= np.abs(series).max(axis=0)
    size = 0.8 * np.minimum(high - home, home - low)
    while True:
        position = home + geometry.active_offset + size * series
        logged = np.round(position / ENCODER) * ENCODER
        estimate = estimate_motion(logged, RATE, SETTINGS)
        inside = time[SETTINGS.border[0] : len(time) - SETTINGS.border[1]]
        track = inside, estimate.position, estimate.velocity, estimate.acceleration
        try:
            return track, motion_of(geometry, *track)
        except BenchError:
            size = 0.8 * size


def main() -> None:
    """Measure the robots that have a limit, show the table, and keep it in results/speed."""
    speeds = [measure(robot) for robot in LIMITS]
    table = Table(title="Projected regressor, closures and accelerations included, µs a sample")
    for heading in ("robot", "columns", "closures", "regressor", "Pinocchio's loop", "ratio", "at most"):
        table.add_column(heading, justify="left" if heading == "robot" else "right")
    for speed in speeds:
        parts = (f"{value:.2f}" for value in (speed.closures, speed.regressor, speed.pinocchio, speed.ratio))
        table.add_row(speed.robot, str(speed.columns), *parts, f"{LIMITS[speed.robot]:g}")
    table_console().print(table)
    rows = [{**asdict(speed), "limit": LIMITS[speed.robot], **versions().columns()} for speed in speeds]
    with atomic_path(RESULT) as path:
        path.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
