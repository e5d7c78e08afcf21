"""Drawings have slack: planar robots a little out of their plane, loops that repeat one another and disagree."""

import numpy as np
import pytest

from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot
from bench.model.model import build_model
from bench.model.motion import motion_of
from bench.model.regressor import projected_regressor
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import CheckCode
from tests.mechanisms import movement, write_robot

# A spherical five-bar: all axes meet in one point, but for the slack of one of them.
SPHERICAL = """
  <worldbody>
    <body name="left"><joint name="left" axis="1 0 0" range="-0.4 0.4"/><geom pos="0.1 0.1 0.02"/>
      <body name="left_arm"><joint name="left_elbow" axis="0.8 0.6 0"/><geom pos="0.05 0.1 0.1"/>
        <site name="tip" pos="0.1 0.12 0.15"/></body></body>
    <body name="right" pos="{slack}"><joint name="right" axis="0 1 0" range="-0.4 0.4"/><geom pos="0.1 0.1 -0.02"/>
      <body name="right_arm"><joint name="right_elbow" axis="0 0.6 0.8"/><geom pos="0.02 0.1 0.1"/>
        <site name="end" pos="0.1 0.12 0.15"/></body></body>
  </worldbody>
  <equality><connect name="tips" site1="tip" site2="end"/></equality>
"""
TILT = 'euler="1e-6 -0.7e-6 0"'  # rad
SLACK = {
    "an axis off the plane": ('<body name="right_crank" pos="0.06 0 0">', f'pos="0.06 0 0" {TILT}>'),
    "a leg off the plane": ('<body name="right_crank" pos="0.06 0 0">', 'pos="0.06 1e-6 0">'),
    "an elbow off its leg": ('<body name="left_rod" pos="0.2 0 0">', f'pos="0.2 1e-6 0" {TILT}>'),
}


def five_bar_with(slack, folder):
    """The built-in five-bar with one body's place changed."""
    text = (built_in_robots()["five_bar"] / "five_bar.xml").read_text(encoding="utf-8")
    before, after = SLACK[slack]
    changed = text.replace(before, f"{before.split(' pos=')[0]} {after}")
    assert changed != text
    (folder / "five_bar.xml").write_text(changed, encoding="utf-8")
    description = (built_in_robots()["five_bar"] / "robot.toml").read_text(encoding="utf-8")
    (folder / "robot.toml").write_text(description, encoding="utf-8")
    return load_robot(folder)


@pytest.mark.parametrize("slack", SLACK)
def test_a_planar_robot_out_of_plane_is_the_planar_one(slack, tmp_path):
    """Its base parameters, and the torque that they give, are those of the drawing without slack."""
    model, exact = build_model(five_bar_with(slack, tmp_path)), build_model(load_robot("five_bar"))
    assert model.base.names == exact.base.names
    torques = []
    for one in (model, exact):
        motion = motion_of(one.geometry, *movement(one.geometry))
        torques.append(projected_regressor(one.geometry, motion, one.base.columns))
    assert np.abs(torques[0] - torques[1]).max() < 1e-4 * np.abs(torques[1]).max()


@pytest.mark.parametrize("slack", SLACK)
def test_the_check_tells_it_and_passes(slack, tmp_path):
    report = check_robot(five_bar_with(slack, tmp_path))
    assert report.failures == ()
    assert (report.mobility.rank, report.mobility.remaining) == (2, 2)
    assert CheckCode.DRAWING_ROUNDED in [check.code for check in report.checks]


def test_more_slack_than_that_is_a_mistake(tmp_path, monkeypatch):
    monkeypatch.setitem(SLACK, "a leg off the plane", (SLACK["a leg off the plane"][0], 'pos="0.06 1e-4 0">'))
    report = check_robot(five_bar_with("a leg off the plane", tmp_path))
    assert [check.code for check in report.failures] == [CheckCode.HOME_OPEN_AND_NO_CLOSED_POSE]


@pytest.mark.parametrize("slack", ["0 0 0", "1e-7 0 0", "0 0 -1e-6"])
def test_axes_that_hardly_miss_one_point(slack, tmp_path):
    report = check_robot(write_robot(tmp_path, SPHERICAL.format(slack=slack), ("left", "right")))
    assert report.failures == ()
    assert (report.mobility.rank, report.mobility.remaining) == (2, 2)
