"""Cost of the projected regressor, including closures and accelerations, compared with Pinocchio's tree regressor.

Both process the same tree and samples, alternately, so that other load on the machine cancels in their ratio.
"""

from time import perf_counter

import numpy as np
import pinocchio as pin

from bench.basics.errors import BenchError
from bench.benchmarks.speed.figures import SpeedFigure
from bench.dataset.robot import load_robot
from bench.model.base import base_parameters
from bench.model.follow import build_tree
from bench.model.geometry import Geometry, read_geometry
from bench.model.motion import motion_of
from bench.model.regressor import projected_regressor
from bench.model.states import active_ranges
from bench.signals.processing import estimate_motion
from bench.signals.settings import FilterSettings

LIMITS = {"five_bar": 6.0, "delta": 4.0}  # times Pinocchio's loop
RATE, DURATION = 1000.0, 20.0  # Hz, s
ENCODER = 2.0 * np.pi / 2**20  # rad
HARMONICS, BASE_FREQUENCY = 5, 0.2  # Hz
SETTINGS = FilterSettings(position_cutoff=30.0, decimation=10, border=(200, 200))
SEED = 20120603
REPEATS = 9


def regressor_figures() -> list[SpeedFigure]:
    """Time of the projected regressor over that of Pinocchio's regressor."""
    name = "regressor over Pinocchio's"
    return [
        SpeedFigure(f"{name}, {robot}", times_pinocchio(robot), "×", limit) for robot, limit in LIMITS.items()
    ]


def times_pinocchio(robot: str) -> float:
    """Time of the regressor over that of Pinocchio's loop; median, for 20 s at 1 kHz with a 20-bit encoder."""
    geometry = read_geometry(load_robot(robot))
    columns = base_parameters(geometry).columns
    track = _movement(geometry)
    tree = build_tree(geometry)
    data, regressor = tree.createData(), pin.computeJointTorqueRegressor
    ratios = []
    for _ in range(REPEATS):
        start = perf_counter()
        motion = motion_of(geometry, *track)
        projected_regressor(geometry, motion, columns)
        projected = perf_counter()
        for q, v, a in zip(motion.q, motion.v, motion.a, strict=True):
            regressor(tree, data, q, v, a)
        ratios.append((projected - start) / (perf_counter() - projected))
    return float(np.median(ratios))


def _movement(geometry: Geometry) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Time, position, velocity and acceleration of a Fourier series within the joint ranges, reduced until the robot
    reaches all of it.
    """
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
            motion_of(geometry, *track)
        except BenchError:
            size = 0.8 * size
        else:
            return track
