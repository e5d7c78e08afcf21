"""No designed movement comes near a pose in which the loops come loose, be it a single one inside the ranges."""

import numpy as np
import pytest

from bench.excitation.bounds import LIMITS
from bench.excitation.design import Movement, design_trajectories
from bench.model.mobility import smallest_singular_values
from bench.model.model import build_model
from bench.model.motion import motion_of
from tests.test_robot_check import elbows_in_line

CENTER = np.array([3.0, 0.1])  # the rods are in line at pi and 0


@pytest.mark.parametrize("rod", [0.26, 0.2601])
def test_rods_are_never_in_line(rod, tmp_path):
    robot = elbows_in_line(tmp_path / "robot", rod)
    movements = [
        Movement(
            name=f"movement {seed}",
            fitted=True,
            payload=None,
            center=CENTER,
            span=np.full(2, 0.6),
            velocity=np.full(2, 5.0),
            acceleration=np.full(2, 60.0),
            harmonics=8,
            base_frequency=0.2,
            duration=20.0,
            ramp=1.0,
            seed=seed,
        )
        for seed in (1, 2)
    ]
    geometry = build_model(robot).geometry
    at_home = smallest_singular_values(geometry, geometry.home[None])[0]
    for trajectory in design_trajectories(robot, movements).trajectories.values():
        time = np.linspace(0.0, trajectory.duration, 10001)  # far more finely than the design looks
        motion = motion_of(geometry, time, *trajectory.evaluate(time))
        assert np.ptp(motion.q[:, geometry.active_configuration], axis=0).min() > 0.05
        assert smallest_singular_values(geometry, motion.q).min() > 0.8 * LIMITS.held * at_home
