"""Robots that the model cannot serve are refused, the joint or the equality named."""

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.model.geometry import read_geometry
from bench.model.mobility import check_mobility
from bench.model.model import build_model
from bench.model.spin import idle_spins
from tests.mechanisms import BALL, NAMES, TILTED, WELDED, robot_named, write_robot

SPINNING_ROD = """
  <worldbody>
    <body name="crank"><joint name="crank" axis="0 1 0"/><geom/>
      <body name="rod" pos="0.2 0 0.1"><joint name="ball" type="ball"/><geom/>
        <site name="rod_end" pos="0.5 0.1 0.1"/></body></body>
    <body name="rocker" pos="0.7 0.1 0"><joint name="rocker" axis="1 0 0" pos="0 0.2 0"/><geom/>
      <site name="rocker_end" pos="0 0 0.2"/></body>
  </worldbody>
  <equality><connect site1="rod_end" site2="rocker_end"/></equality>
"""

# Both rods along the line between their elbows: the tip can go either way.
STRETCHED = """
  <worldbody>
    <body name="left_crank"><joint name="left" axis="0 0 1"/><geom/>
      <body name="left_rod" pos="0 0.2 0"><joint name="left_elbow" axis="0 0 1"/><geom/></body></body>
    <body name="right_crank" pos="0.5 0 0"><joint name="right" axis="0 0 1"/><geom/>
      <body name="right_rod" pos="0 0.2 0"><joint name="right_elbow" axis="0 0 1"/><geom/></body></body>
  </worldbody>
  <equality><connect body1="left_rod" body2="right_rod" anchor="0.3 0 0"/></equality>
"""

COUPLED = """
  <worldbody><body name="a"><joint name="a"/><geom/><body name="b"><joint name="b"/><geom/></body></body></worldbody>
"""
TENDON = """<tendon>{}<fixed name="belt"><joint joint="a" coef="1"/><joint joint="b" coef="-1"/></fixed></tendon>"""


def refusal(folder, body, motors):
    with pytest.raises(BenchError) as error:
        build_model(write_robot(folder, body, motors))
    message = str(error.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("name", NAMES)
def test_what_can_be_served_is(name, tmp_path):
    check_mobility(read_geometry(robot_named(name, tmp_path)))


def test_rod_that_spins_between_two_balls_is_served(tmp_path):
    robot = write_robot(tmp_path, SPINNING_ROD, ("crank",))
    (spin,) = idle_spins(build_model(robot).geometry)
    assert spin.axis == pytest.approx(np.array([0.5, 0.1, 0.1]) / np.sqrt(0.27))


def test_two_spins_of_one_line_are_too_many(tmp_path):
    """A rod of two halves with a ball joint between them dangles."""
    halves = SPINNING_ROD.replace('<site name="rod_end" pos="0.5 0.1 0.1"/>', "{}").format(
        '<body name="half" pos="0.2 0 0"><joint name="knee" type="ball"/><geom/>'
        '<site name="rod_end" pos="0.3 0.1 0.1"/></body>'
    )
    assert "can move with all motors held" in refusal(tmp_path, halves, ("crank",))


def test_joint_that_dangles_from_a_loop(tmp_path):
    hanging = '<body name="hook" pos="0 0 0.1"><joint name="hook"/><geom/></body><body name="weight"'
    message = refusal(tmp_path, TILTED.replace('<body name="weight"', hanging), ("left", "right"))
    assert "joint 'hook' can move with all motors held" in message


def test_joint_without_a_motor_and_without_a_loop(tmp_path):
    assert "joint 'b'" in refusal(tmp_path, COUPLED, ("a",))


def test_too_few_motors(tmp_path):
    message = refusal(tmp_path, TILTED, ("left",))
    assert "'left_elbow', 'right' and 'right_elbow' can move" in message


@pytest.mark.parametrize(
    ("body", "motors", "redundant"),
    [
        (TILTED, ("left", "right", "left_elbow"), "left_elbow"),
        (TILTED, ("left_elbow", "left", "right"), "right"),
        (WELDED, ("crank", "rocker", "turn"), "rocker"),
    ],
)
def test_motors_that_those_before_them_determine_are_redundant(tmp_path, body, motors, redundant):
    geometry = build_model(write_robot(tmp_path, body, motors)).geometry
    own = geometry.joints[geometry.joint_index(redundant)]
    assert geometry.redundant.tolist() == [own.v.start]
    assert own.v.start in geometry.passive
    assert geometry.robot.joints == tuple(joint for joint in motors if joint != redundant)


def test_locked_mechanism(tmp_path):
    """An axis out of parallel locks the four-bar; the turntable still turns."""
    body = WELDED.replace('name="pin_b" axis="0 1 0"', 'name="pin_b" axis="0.2 1 0"')
    assert "joint 'crank' cannot move" in refusal(tmp_path, body, ("crank", "turn"))


def test_singular_home(tmp_path):
    message = refusal(tmp_path, STRETCHED, ("left", "right"))
    assert "home is a singular pose: joints 'left_elbow' and 'right_elbow' can move" in message


def test_open_home(tmp_path):
    body = BALL.replace('name="grip" pos="-0.1 0 0"', 'name="grip" pos="-0.18 0.05 0"')
    assert "loop 'grip' is open by 0.08 m in" in refusal(tmp_path, body, ("crank",))


@pytest.mark.parametrize(
    "equality",
    [
        '<equality><joint name="gear" joint1="a" joint2="b"/></equality>',
        TENDON.format("") + '<equality><tendon name="gear" tendon1="belt"/></equality>',
    ],
)
def test_couplings_take_a_degree_of_freedom(tmp_path, equality):
    assert build_model(write_robot(tmp_path, COUPLED + equality, ("a",))).geometry.passive.tolist() == [1]
    both = build_model(write_robot(tmp_path, COUPLED + equality, ("a", "b"))).geometry
    assert (both.active.tolist(), both.redundant.tolist()) == ([0], [1])


def test_cables_are_refused(tmp_path):
    cable = """<tendon><spatial name="rope"><site site="s"/><site site="t"/></spatial></tendon>
      <actuator><motor name="winch" tendon="rope"/></actuator>"""
    body = COUPLED.replace('<geom/><body name="b">', '<geom/><site name="s"/><body name="b"><site name="t"/>')
    assert "tendon 'rope' is a cable in space with motor 'winch' on it" in refusal(
        tmp_path, body + cable, ("a", "b")
    )


def test_coupling_that_is_open_at_home(tmp_path):
    equality = '<equality><joint name="gear" joint1="a" joint2="b" polycoef="0.1 1 0 0 0"/></equality>'
    said = refusal(tmp_path, COUPLED + equality, ("a",))
    assert "equality 'gear' of joints 'a' and 'b' is open by 0.1 rad in" in said


def test_equality_that_is_switched_off_is_none(tmp_path):
    equality = '<equality><joint name="gear" joint1="a" joint2="b" active="false"/></equality>'
    assert not read_geometry(write_robot(tmp_path, COUPLED + equality, ("a", "b"))).loops
