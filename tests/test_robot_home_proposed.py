"""The home that `bench robot check` proposes is one that it accepts."""

import re

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.robot_check.check import check_robot
from bench.robot_check.range_words import home_key
from bench.robot_check.words import detail_of, nearest_singularity
from tests.small_robots import write_robot

CRANK_AND_CARRIAGE = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="crank">
      <joint name="left" axis="0 -1 0"/>
      <geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.012"/>
      <body name="coupler" pos="0.25 0 0">
        <joint name="elbow" axis="0 -1 0"/>
        <geom type="capsule" fromto="0 0 0 0.35 0 0" size="0.01"/>
        <site name="tool" pos="0.35 0 0"/>
      </body>
    </body>
    <body name="carriage">
      <joint name="right" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.04 0.03 0.02"/>
      <body name="rod">
        <joint name="hinge" axis="0 -1 0"/>
        <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.01"/>
        <site name="end" pos="0.4 0 0"/>
      </body>
    </body>
  </worldbody>
  <equality><connect site1="tool" site2="end"/></equality>
  {keyframe}
</mujoco>
"""
MOTORS = {"left": "N*m/A", "right": "N/A"}
SINGULAR = '<keyframe><key name="home" qpos="0 0 0.2 0"/></keyframe>'


def check_of(folder, keyframe):
    write_robot(folder, CRANK_AND_CARRIAGE.format(keyframe=keyframe), MOTORS)
    return check_robot(load_robot(folder))


@pytest.mark.parametrize("keyframe", ["", SINGULAR])
def test_where_the_drawn_pose_is_singular_another_is_proposed(tmp_path, keyframe):
    first = check_of(tmp_path / "drawn", keyframe)
    (failed,) = first.failures
    (proposed,) = re.findall("<key .*/>", detail_of(failed))
    assert not check_of(tmp_path / "mended", f"<keyframe>{proposed}</keyframe>").failures


def test_positions_of_hinges_and_slides_have_their_units(tmp_path):
    (failed,) = check_of(tmp_path / "drawn", "").failures
    (proposed,) = re.findall("<key .*/>", detail_of(failed))
    report = check_of(tmp_path / "mended", f"<keyframe>{proposed}</keyframe>")
    assert report.singularity.units == {"left": "rad", "right": "m"}
    assert re.search(r"left [-+.\d]+ rad, right [-+.\d]+ m", nearest_singularity(report.singularity))


LIFT = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="crank">
      <joint name="crank" axis="0 -1 0" range="-1 1"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.01"/>
      <body name="rod" pos="0.3 0 0">
        <joint name="rod" axis="0 -1 0"/>
        <geom type="capsule" fromto="0 0 0 -0.1 0 -0.38" size="0.01"/>
        <site name="end" pos="-0.1 0 -0.38"/>
      </body>
    </body>
    <body name="lift">
      <joint name="lift" type="slide" axis="0 0 1" range="-0.05 0.6"/>
      <geom type="box" size="0.04 0.03 0.02"/>
      <site name="tool" pos="0.1 0 0"/>
    </body>{idle}
  </worldbody>
  <equality><connect site1="tool" site2="end"/></equality>
  {keyframe}
</mujoco>
"""
IDLE = """
    <body name="foot" pos="0 1 0"><joint name="foot" axis="0 1 0"/><geom size="0.05"/></body>"""


def proposed(folder, idle="", keyframe="", crank="-1 1"):
    """Positions of crank, rod and lift in the pose that is proposed."""
    mjcf = LIFT.format(idle=idle, keyframe=keyframe).replace("-1 1", crank)
    write_robot(folder, mjcf, {"crank": "N*m/A"})
    (pose,) = {
        key
        for check in check_robot(load_robot(folder)).checks
        for key in re.findall("<key .*/>", detail_of(check))
    }
    return [float(position) for position in re.findall(r"[-+.\de]+", pose.partition("qpos=")[2])]


def test_a_joint_that_nothing_holds_does_not_put_the_proposed_pose_outside_the_ranges(tmp_path):
    """Drawn below the range, the lift closes there first; above, it closes within the range."""
    height = np.sqrt(0.1**2 + 0.38**2 - 0.2**2)
    rod = np.arctan2(-height, -0.2) - np.arctan2(-0.38, -0.1)
    below = f'<keyframe><key name="home" qpos="0 {rod:.16g} {-height:.16g} 0"/></keyframe>'
    assert proposed(tmp_path / "held")[2] == pytest.approx(height)
    assert proposed(tmp_path / "idle", IDLE)[2] == pytest.approx(height)
    assert proposed(tmp_path / "below", IDLE, below)[2] == pytest.approx(height)


def test_a_proposed_pose_has_no_digits_that_are_rounding():
    assert home_key([1.9e-32, -8.95e-17, 0.1 + 0.2, -2.467128845306809e-07]) == (
        '<key name="home" qpos="0 0 0.3 -2.46713e-07"/>'
    )


def test_the_first_proposed_pose_is_already_inside_the_ranges(tmp_path):
    """As drawn, the crank is at the end of its range: with the motor held there, the lift closes as well."""
    crank, _, lift = proposed(tmp_path / "robot", crank="0 0.5")
    assert 0.05 * 0.5 < crank < 0.95 * 0.5
    assert lift > 0.0
