"""The robot with six motors on which the report is measured is one that the bench can model."""

from bench.benchmarks.speed.report import LEGS, write_hexapod
from bench.dataset.robot import load_robot
from bench.robot_check.check import check_robot


def test_the_platform_on_six_legs_passes_the_check_of_robots(tmp_path):
    robot = load_robot(write_hexapod(tmp_path / "hexapod"))
    assert len(robot.actuators) == LEGS
    assert [one for one in check_robot(robot).checks if one.verdict == "failed"] == []
