"""Joint ranges that no file gives are assumed, and `bench excite` says so with numbers."""

from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.robot import Actuator, load_robot
from bench.excitation.experiment.figure import plan_figure
from bench.excitation.experiment.forecast import forecast
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable, assumed_ranges
from bench.excitation.experiment.room import room_of
from bench.excitation.experiment.sentences import sentences
from bench.model.geometry import read_geometry
from tests.small_robots import SERIAL, write_robot

MOTORS = {"shoulder": "N*m/A", "elbow": "N*m/A"}
QUICK = {"duration": 5.0, "harmonics": 3, "velocity": 3.0, "acceleration": 20.0}
WIDE = {"shoulder": (-9.0, 9.0)}


def table(**changes):
    return ExperimentTable.model_validate({**QUICK, **changes})


@pytest.fixture
def robot(tmp_path):
    write_robot(tmp_path / "arm", SERIAL, MOTORS)
    return load_robot(tmp_path / "arm")


def test_ranges_that_no_file_gives_are_assumed_with_numbers_and_the_way_to_set_them(robot):
    plan = plan_experiment(robot, table(), Aim(steps=1))
    low, high = plan.room.joint.low, plan.room.joint.high
    assert plan.room.unranged == ("shoulder", "elbow")
    lines = sentences(plan, forecast(plan, None))
    (assumed,) = [line for line in lines if line.startswith("Assumed, because not given")]
    ranges = f"range: shoulder {low[0]:.3g} to {high[0]:.3g} rad, elbow {low[1]:.3g} to {high[1]:.3g} rad"
    assert f"{ranges} (write `range` at each joint in the MJCF)" in assumed
    assert any(line.startswith("Ranges (assumed at shoulder and elbow), speeds and acc") for line in lines)
    (legend,) = plan_figure(plan).legends
    assert legend.get_texts()[-1].get_text() == "limits (ranges assumed)"


@pytest.mark.parametrize(
    ("drives", "cure"),
    [
        ("tendon", "write `range` at each tendon in the MJCF"),
        ("motor", "write `position` in the file of --limits"),
    ],
)
def test_a_motor_on_a_tendon_has_its_range_there(robot, drives, cure):
    arm = replace(robot, actuators=(Actuator("cable", 2.0, "N*m/A", drives),))
    assumed = assumed_ranges(arm, ("cable",), np.array([-0.5]), np.array([1.0]))
    assert assumed == f"range: cable -0.5 to 1 rad ({cure})"


def test_a_range_of_the_limits_file_takes_the_place_of_the_assumed_one(robot):
    room = room_of(read_geometry(robot), table(position=WIDE))
    assert (room.joint.low[0], room.joint.high[0]) == WIDE["shoulder"]
    assert room.unranged == ("elbow",)
    assert "shoulder" not in room.assumed[0]


def test_ranges_of_the_mjcf_are_not_assumed_and_hold_beyond_the_limits_file():
    room = room_of(read_geometry(load_robot("two_link")), table(position=WIDE))
    assert room.unranged == room.assumed == ()
    assert room.joint.high[0] < WIDE["shoulder"][1]
