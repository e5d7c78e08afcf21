"""A robot that motors and closures do not determine is refused with the edit that mends it, and the edit does."""

import re

import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.model.model import build_model
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import CheckCode
from bench.robot_check.words import detail_of, name_of
from tests.mechanisms import TILTED, WELDED, write_robot

LEG = """<body name="thigh_{s}" pos="0 {y} 0"><joint name="hip_{s}" axis="0 1 0"/><geom/>
  <body name="shin_{s}" pos="0 0 -.3"><joint name="knee_{s}" axis="0 1 0"/><geom/><site name="foot_{s}" pos="0 0 -.3"/>
  </body></body>"""
LEGS = LEG.format(s="left", y=0.1) + LEG.format(s="right", y=-0.1)
HUMANOID = f"""<worldbody><body name="pelvis" pos="0 0 1">{{free}}<geom/>{LEGS}</body>{{more}}</worldbody>
  {{equality}}<keyframe><key name="home" qpos="{{pose}}0 0 0 0{{last}}"/></keyframe>"""
FREE = {"free": '<freejoint name="root"/>', "more": "", "equality": "", "pose": "0 0 1 1 0 0 0 ", "last": ""}
FIXED = {**FREE, "free": "", "pose": ""}
HELD_BAR = '<body name="bar" pos=".1 0 1"><freejoint/><geom/></body>'
GRASP = '<equality><weld body1="bar" body2="shin_left"/></equality>'
MOTORS = ("hip_left", "knee_left", "hip_right", "knee_right")

LEAF = """<worldbody><body name="arm"><joint name="arm" axis="0 1 0"/><geom/>
  <body name="foot" pos=".3 0 0"><joint name="leaf" axis="0 1 0" stiffness="80" ref="0.1"/><geom pos=".1 0 0"/>{gripper}
  </body></body></worldbody>"""
GRIPPER = """<body name="jaw"><joint name="jaw" type="slide" axis="0 1 0"/><geom/></body>
  <body name="other"><joint name="other" type="slide" axis="0 1 0"/><geom/></body>"""
PINNED = TILTED.replace('<connect name="tips"', '<weld name="tips"')
SITES = ('<site name="tool"', '<site name="l" pos="0.22 0.24 0"/><site name="tool"')
BY_SITES = (  # turned to one another
    PINNED.replace(*SITES)
    .replace('<geom pos="-0.1 0.1', '<site name="r" pos="-0.25 0.23 0" euler="0 0 0.5"/><geom pos="-0.1 0.1')
    .replace('body1="left_rod" body2="right_rod" anchor="0.22 0.24 0"', 'site1="l" site2="r"')
)


def refusal(robot):
    with pytest.raises(BenchError) as error:
        build_model(robot)
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize(
    "parts",
    [
        FREE,
        {**FREE, "more": HELD_BAR, "equality": GRASP, "pose": "0 0 1 1 0 0 0 0 0 0 0 "},
        {
            **FREE,
            "equality": '<equality><connect body1="shin_left" body2="shin_right" anchor="0 0 0"/></equality>',
        },
    ],
)
def test_a_base_that_floats_is_refused_with_the_edit_that_fixes_it(parts, tmp_path):
    body = HUMANOID.format(**{**FREE, **parts})
    message = refusal(write_robot(tmp_path, body, MOTORS))
    assert "body 'pelvis' floats" in message
    assert "remove its <freejoint/>" in message
    assert "7 numbers" in message


def test_the_edit_fixes_the_base(tmp_path):
    build_model(write_robot(tmp_path, HUMANOID.format(**FIXED), MOTORS))


def test_a_base_that_closures_hold_does_not_float(tmp_path):
    feet = "".join(f'<connect body1="shin_{side}" anchor="0 0 -.3"/>' for side in ("left", "right"))
    body = HUMANOID.format(**{**FREE, "equality": f"<equality>{feet}</equality>"})
    assert "floats" not in refusal(write_robot(tmp_path, body, MOTORS))


def test_a_loose_body_without_motors_is_no_base(tmp_path):
    message = refusal(
        write_robot(
            tmp_path,
            LEAF.format(gripper="").replace("</worldbody>", f"{HELD_BAR}</worldbody>"),
            ("arm", "leaf"),
        )
    )
    assert "floats" not in message
    assert "has no motor" in message


@pytest.mark.parametrize(
    ("body", "motors", "said"),
    [
        (
            LEAF.format(gripper=""),
            ("arm",),
            "its spring is not in the model, lock it by a first line of robot.toml: locked = {leaf = 0.1}",
        ),
        (LEAF.format(gripper=GRIPPER), ("arm",), "joints 'leaf', 'jaw' and 'other' have no motor"),
        (
            LEAF.format(gripper=GRIPPER),
            ("arm", "leaf"),
            "if they are held, lock them by a first line of robot.toml: locked = {jaw = 0.0, other = 0.0}",
        ),
        (
            f"{LEAF.format(gripper=GRIPPER)}<keyframe><key name='home' qpos='0 0 -7.4941786e-30 0.02'/></keyframe>",
            ("arm", "leaf"),
            "if they are held, lock them by a first line of robot.toml: locked = {jaw = 0.0, other = 0.02}",
        ),
        (
            TILTED,
            ("left",),
            "a lock is missing, for example as the first line of robot.toml: locked = {left_elbow = -0.2",
        ),
        (
            TILTED.replace('name="right_elbow" axis', 'name="right_elbow" stiffness="3" axis'),
            ("left",),
            "its spring is not in the model, lock it by a first line of robot.toml: locked = {right_elbow = 0.5}",
        ),
    ],
)
def test_what_nothing_determines_is_locked_by_the_line_that_is_told(body, motors, said, tmp_path):
    robot = write_robot(tmp_path, body, motors)
    message = refusal(robot)
    assert said in message
    line = re.search(r"locked = \{.*?\}", message).group()
    toml = tmp_path / "robot.toml"
    toml.write_text(f"{line}\n{toml.read_text()}")
    assert build_model(load_robot(tmp_path)).geometry.robot.joints == motors


def test_a_robot_that_already_locks_joints_gets_further_lines_of_its_table(tmp_path):
    robot = write_robot(tmp_path, LEAF.format(gripper=GRIPPER), ("arm", "leaf"))
    toml = tmp_path / "robot.toml"
    toml.write_text(f"{toml.read_text()}\n[locked]\njaw = 0.0\n")
    message = refusal(load_robot(tmp_path))
    assert "lock it under [locked] in robot.toml: `other = 0.0`" in message
    line = re.search(r"`(other = .*?)`", message).group(1)
    toml.write_text(f"{toml.read_text()}{line}\n")
    assert build_model(load_robot(tmp_path)).geometry.robot.joints == robot.joints


def test_a_pin_closed_by_a_weld_asks_for_a_connect(tmp_path):
    """Open in its orientation it is refused; closed it is a robot of one degree of freedom, which is noted."""
    robot = write_robot(tmp_path, BY_SITES, ("left", "right"))
    assert "use <connect> instead of weld 'tips'" in refusal(robot)
    first = check_robot(robot).failures[0]
    assert (name_of(first), first.code) == ("loop closures", CheckCode.WELD_TOO_MUCH)
    closed = check_robot(write_robot(tmp_path, PINNED, ("left", "right")))
    assert closed.failures == ()
    noted = next(check for check in closed.checks if check.code == CheckCode.WELD_TOO_MUCH)
    assert "so that right cannot move independently" in detail_of(noted)
    build_model(write_robot(tmp_path, BY_SITES.replace("<weld", "<connect"), ("left", "right")))


def test_a_weld_that_locks_all_motors_asks_for_a_connect(tmp_path):
    """A four-bar of three joints closed at its last pin."""
    body = WELDED.replace('<joint name="pin_b" axis="0 1 0"/>', "")
    with pytest.raises(BenchError, match=r"'crank' cannot move .* use <connect> instead of weld 'coupler'"):
        write_robot(tmp_path, body, ("crank", "turn"))


def test_a_redundant_motor_is_no_fault_of_a_weld_between_halves(tmp_path):
    robot = write_robot(tmp_path, WELDED, ("crank", "turn"))
    assert not [check for check in check_robot(robot).checks if check.code == CheckCode.WELD_TOO_MUCH]


CUT_ROD = """
<worldbody>
  <body pos="0 0 1"><joint name="x" type="slide" axis="0 0 1"/><geom size="0.1"/>
    <body><joint name="upper" type="ball"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 -0.5" size="0.02"/><site name="up" pos="0.3 0 -0.5"/></body></body>
  <body pos="0.6 0 0"><joint name="rail" type="slide" axis="1 0 0"/><geom size="0.05"/>
    <body><joint name="lower" type="ball"/>
      <geom type="capsule" fromto="0 0 0 -0.3 0 0.5" size="0.02"/><site name="down" pos="-0.3 0 0.5"/></body></body>
</worldbody>
<equality><weld name="half" site1="up" site2="down"/></equality>
"""


def test_a_rod_that_a_weld_cuts_between_its_balls_is_to_be_cut_at_a_ball(tmp_path):
    """Its spin is no idle spin of a rod."""
    message = refusal(write_robot(tmp_path, CUT_ROD, ("x",)))
    assert "joints 'upper' and 'lower' can move with all motors held" in message
    assert "that a <weld> cuts between them (half) spins freely: cut it at one of its balls" in message
