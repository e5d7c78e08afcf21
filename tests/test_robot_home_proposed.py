"""The home that `bench robot check` proposes is one that it accepts."""

import re

import pytest

from bench.dataset.robot import load_robot
from bench.robot_check.check import check_robot
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
