"""Rods with a ball joint at both ends: their spin is none, and all else moves as with a universal joint."""

import re

import numpy as np
import pytest

from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot
from bench.model.base import base_parameters
from bench.model.closure import loop_residual
from bench.model.geometry import read_geometry
from bench.model.motion import motion_of
from bench.model.regressor import projected_regressor
from bench.model.spin import idle_spins
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.words import detail_of
from tests.mechanisms import movement, write_robot

# A slider-crank in space; the rod lies along its own z axis.
SLIDER_CRANK = """
  <worldbody>
    <body name="crank"><joint name="crank" axis="0.3 1 0.2"/><geom pos="0.1 0.02 0.05" euler="0.1 0.3 0"/>
      <body name="rod" pos="0.2 0 0.1" euler="0.4 1.2 0.1">{joints}
        <geom type="cylinder" size=".02 .25" pos="0 0 .25"/><site name="rod_end" pos="0 0 0.5"/></body></body>
    <body name="slider" pos="0.68 0.02 0.235"><joint name="slide" type="slide" axis="1 0.2 0.1"/>
      <geom pos="0.02 0.03 0.01"/><site name="grip" pos="{grip}"/></body>
  </worldbody>
  <equality><connect name="grip" site1="rod_end" site2="grip"/></equality>
"""
BALL = '<joint name="ball" type="ball"/>'
UNIVERSAL = '<joint name="pitch" axis="0 1 0"/><joint name="roll" axis="1 0 0"/>'
ROD = 1  # the joint that carries it


def robot_with(joints, folder):
    folder.mkdir()
    turn = read_geometry(
        write_robot(folder, SLIDER_CRANK.format(joints=UNIVERSAL, grip="0 0 0"), ("crank",))
    ).joints[ROD]
    end = turn.placement.translation + turn.placement.rotation @ [0, 0, 0.5]
    grip = " ".join(f"{value:.17g}" for value in end - [0.68, 0.02, 0.235])
    return write_robot(folder, SLIDER_CRANK.format(joints=joints, grip=grip), ("crank",))


@pytest.fixture
def spun(tmp_path):
    return robot_with(BALL, tmp_path / "ball")


@pytest.fixture
def held(tmp_path):
    return robot_with(UNIVERSAL, tmp_path / "universal")


def test_the_rod_spins_and_no_other(spun, held):
    (spin,) = idle_spins(read_geometry(spun))
    assert spin.joint == ROD
    assert spin.axis == pytest.approx([0, 0, 1])
    assert idle_spins(read_geometry(held)) == ()


def test_the_other_joints_move_as_with_a_universal_joint(spun, held):
    motions = []
    for robot in (spun, held):
        geometry = read_geometry(robot)
        motion = motion_of(geometry, *movement(geometry))
        assert np.abs(loop_residual(geometry, motion.q.T)).max() < 1e-11
        slide = geometry.joints[-1]
        motions.append(
            [motion.q[:, slide.q], motion.v[:, slide.v], motion.a[:, slide.v], motion.jacobian[:, slide.v]]
        )
    for ours, theirs in zip(*motions, strict=True):
        assert np.abs(ours - theirs).max() < 1e-9 * max(1.0, np.abs(theirs).max())


def test_the_rod_does_not_turn_about_its_own_axis(spun):
    """Nor does the inertia about it show in any motor's torque."""
    geometry = read_geometry(spun)
    motion = motion_of(geometry, *movement(geometry))
    own = projected_regressor(geometry, motion, 10 * ROD + np.arange(10))
    assert np.abs(own[:, :, 9]).max() < 1e-9 * np.abs(own).max()
    assert "Izz(rod)" not in " ".join(base_parameters(geometry).descriptions)


def test_the_mass_of_a_slender_rod_is_felt_as_with_a_universal_joint(spun, held):
    """Mass on the rod's axis; its inertia about the axis is what a universal joint would turn."""
    mass = np.array([2.0, 0, 0, 0.5, 0.17, 0, 0.17, 0, 0, 0.0])
    torques = []
    for robot, carrier in ((spun, ROD), (held, ROD + 1)):
        geometry = read_geometry(robot)
        motion = motion_of(geometry, *movement(geometry))
        torques.append(projected_regressor(geometry, motion, 10 * carrier + np.arange(10)) @ mass)
    assert np.abs(torques[0] - torques[1]).max() < 1e-9 * np.abs(torques[1]).max()


def test_the_check_passes_and_says_it(spun):
    report = check_robot(spun)
    assert report.failures == ()
    assert (report.mobility.rank, report.mobility.spins, report.mobility.remaining) == (3, 1, 1)
    (spins,) = [check for check in report.checks if check.code is CheckCode.ROD_SPINS]
    assert spins == Check(CheckCode.ROD_SPINS, "note", {"bodies": ["rod"]})
    assert detail_of(spins) == (
        "'rod': free to spin about the line through the joints at both ends, the motors held. "
        "The model assumes no spin, which is exact if a rod's mass lies on that line"
    )


@pytest.mark.parametrize("tool", [None, "rod_end"])
def test_a_rod_that_carries_the_tool_may_not_spin(spun, tool):
    robot = write_robot(
        spun.folder, (spun.folder / "robot.xml").read_text().split("</default>")[1][:-9], ("crank",), tool
    )
    assert len(idle_spins(read_geometry(robot))) == (tool is None)


def test_a_hexapod_with_ball_joints_at_both_ends_of_its_legs(tmp_path):
    """6-SPS for 6-UPS: the same base parameters but those of the legs' turning about themselves."""
    source = built_in_robots()["stewart"]
    text = (source / "stewart.xml").read_text(encoding="utf-8")
    universal = r'<joint name="tilt_(\d)" class="tilt"/>\s*<joint name="swing_\d" class="swing"/>'
    text = re.sub(universal, r'<joint name="foot_\1" type="ball"/>', text)
    home = " ".join(["1 0 0 0 0"] * 6 + ["0 0 0.65 1 0 0 0"])
    text = re.sub(r'name="home" qpos="[^"]*"', f'name="home" qpos="{home}"', text)
    (tmp_path / "stewart.xml").write_text(text, encoding="utf-8")
    (tmp_path / "robot.toml").write_bytes((source / "robot.toml").read_bytes())
    report = check_robot(load_robot(tmp_path))
    assert report.failures == ()
    assert (report.mobility.tree, report.mobility.spins, report.mobility.remaining) == (30, 6, 6)
