"""Grippers, hands and legs as other people draw them: couplings by tendons, springs on stops, pins of a whole turn."""

import re

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.mjcf_files import unreadable
from bench.dataset.robot import load_robot
from bench.dataset.robot_toml import write_robot_toml
from bench.excitation.bounds import LIMITS
from bench.excitation.experiment.request import ExperimentTable
from bench.excitation.experiment.room import room_of
from bench.model.geometry import read_geometry
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import CheckCode
from bench.robot_check.words import detail_of

INERTIAL = '<inertial pos="0.01 0.002 0.03" mass="0.1" diaginertia="1e-4 1e-4 2e-5"/>'

# One finger of an adaptive gripper: four bars and a spring that holds the coupler at its stop.
FINGER = f"""<body name="driver" pos="0.03 0 0.05"><joint name="driver" axis="0 1 0" range="0 0.8"/>{INERTIAL}
    <body name="coupler" pos="0.03 0 0"><joint name="coupler" axis="0 1 0" range="-1.5 0"/>{INERTIAL}
      <site name="upper" pos="0.01 0 0.045"/></body></body>
  <body name="link" pos="0.013 0 0.06">
    <joint name="link" axis="0 1 0" range="-0.3 0.8" stiffness="0.05" springref="2.6"/>{INERTIAL}
    <body name="follower" pos="0.035 0 0.055"><joint name="follower" axis="0 1 0" range="-0.9 0.9"/>{INERTIAL}
      <site name="lower" pos="0.022 0 -0.02"/><site name="tip" pos="0 0 0.03"/></body></body>"""
PIN = '<connect site1="upper" site2="lower"/>'

# A finger of three links, each coupled to the next by a tendon that an equality holds.
CHAIN = f"""<body name="a"><joint name="a" axis="0 1 0" range="-1 1"/>{INERTIAL}
    <body name="b" pos="0 0 0.06"><joint name="b" axis="0 1 0" range="-1 1"/>{INERTIAL}
      <body name="c" pos="0 0 0.05"><joint name="c" axis="0 1 0" range="-1 1"/>{INERTIAL}
        <site name="tip" pos="0 0 0.03"/></body></body></body>"""
TENDONS = """<tendon>
  <fixed name="ab" {ab}><joint joint="a" coef="1"/><joint joint="b" coef="-1.5"/></fixed>
  <fixed name="bc" {bc}><joint joint="b" coef="1"/><joint joint="c" coef="-1"/></fixed></tendon>"""
HELD = '<tendon tendon1="ab"/><tendon tendon1="bc"/>'


def robot(folder, body, equality, motors, rest="", tool="tip", locked=""):
    folder.mkdir(exist_ok=True)
    path = folder / "robot.xml"
    path.write_text(
        f'<mujoco><compiler angle="radian"/><worldbody>{body}</worldbody><equality>{equality}</equality>{rest}</mujoco>'
    )
    write_robot_toml(path, [(motor, 2.0) for motor in motors], tool=tool, overwrite=True)
    with (folder / "robot.toml").open("a") as file:
        file.write(locked)
    return load_robot(folder)


def failures(report):
    return [detail_of(check) for check in report.failures]


def notes(report, code):
    return [detail_of(check) for check in report.checks if check.code == code]


# --- a spring presses a joint against its stop --------------------------------------------------------------


def test_joints_at_their_stops_are_offered_where_springs_leave_a_motion(tmp_path):
    (failure,) = failures(check_robot(robot(tmp_path / "free", FINGER, PIN, ["driver"])))
    springs, stops = re.findall(r"locked = \{(\w+ = -?[\d.e-]+)\}", failure)
    assert springs.startswith("link")
    assert stops.startswith("coupler")
    for number, line in enumerate((springs, stops)):
        held = robot(tmp_path / str(number), FINGER, PIN, ["driver"], locked=f"[locked]\n{line}\n")
        assert failures(check_robot(held)) == []


def test_a_home_further_inside_is_another_pose(tmp_path):
    """A passive joint at the end of its range: the pose that is proposed has room for it."""
    tendon = '<tendon><fixed name="drive"><joint joint="driver" coef="0.5"/></fixed></tendon>'
    locked = "[locked]\ncoupler = 0.0\n"
    report = check_robot(robot(tmp_path / "drawn", FINGER, PIN, ["drive"], tendon, locked=locked))
    (note,) = notes(report, CheckCode.HOME_AT_RANGE_END)
    assert "'driver'" in note
    (key,) = re.findall("<key .*/>", note)
    inside = robot(
        tmp_path / "inside", FINGER, PIN, ["drive"], f"{tendon}<keyframe>{key}</keyframe>", locked=locked
    )
    assert notes(check_robot(inside), CheckCode.HOME_AT_RANGE_END) == []


def test_a_home_that_is_singular_is_mended_with_the_locked_joints(tmp_path):
    """The key that is proposed has all positions of the file, those of locked joints too."""
    arms = "".join(
        f'<body name="m{i}" pos="{x} 0 0"><joint name="m{i}" axis="0 1 0"/>{INERTIAL}<body name="r{i}" pos="0 0 0.1">'
        f'<joint name="r{i}" axis="0 1 0"/>{INERTIAL}<site name="e{i}" pos="{end} 0 0"/>{gripper}</body></body>'
        for i, x, end, gripper in (
            (1, -0.1, 0.1, f'<body name="g"><joint name="g" axis="0 0 1"/>{INERTIAL}</body>'),
            (2, 0.1, -0.1, ""),
        )
    )
    pin, locked = '<connect site1="e1" site2="e2"/>', "[locked]\ng = 0.3\n"
    (failure,) = failures(
        check_robot(robot(tmp_path / "drawn", arms, pin, ["m1", "m2"], tool="e1", locked=locked))
    )
    (key,) = re.findall("<key .*/>", failure)
    keyframe = f"<keyframe>{key}</keyframe>"
    mended = robot(tmp_path / "mended", arms, pin, ["m1", "m2"], keyframe, tool="e1", locked=locked)
    assert failures(check_robot(mended)) == []


# --- couplings by tendons -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "part", ['range="0 1"', 'stiffness="3" springlength="0.2" frictionloss="0.4" damping="0.1"']
)
def test_what_acts_on_a_tendon_of_constant_length_does_no_work(part, tmp_path):
    plain, acting = (
        robot(tmp_path / name, CHAIN, HELD, ["a"], TENDONS.format(ab=text, bc=text))
        for name, text in (("plain", ""), ("acting", part))
    )
    reports = [check_robot(each) for each in (plain, acting)]
    assert [failures(report) for report in reports] == [[], []]
    np.testing.assert_array_equal(reports[0].base.grouping, reports[1].base.grouping)
    simulated = acting.mjcf_model()
    for field in ("stiffness", "damping", "frictionloss", "limited"):
        assert not np.any(getattr(simulated, f"tendon_{field}")), field


def coupled(folder, ranges, equality):
    """A chain whose joints have these ranges."""
    body = CHAIN
    for joint, ends in ranges.items():
        body = body.replace(
            f'name="{joint}" axis="0 1 0" range="-1 1"', f'name="{joint}" axis="0 1 0" range="{ends}"'
        )
    return robot(folder, body, equality, ["a"])


def proportional(first, second, factor=1):
    return f'<joint joint1="{first}" joint2="{second}" polycoef="0 {factor} 0 0 0"/>'


@pytest.mark.parametrize(
    ("equality", "equation"),
    [
        (proportional("b", "a", -1), "1 b = -1 x^1 with x = 1 a"),
        ('<joint joint1="b" joint2="a" polycoef="0 -1 -2 0 0"/>', "1 b = -1 x^1 + -2 x^2 with x = 1 a"),
    ],
)
def test_couplings_that_contradict_the_ranges_are_named(equality, equation, tmp_path):
    """No pose has room for planned motions, and none is proposed."""
    drawn = coupled(tmp_path, {"a": "0 1", "b": "0 1"}, equality + proportional("c", "b"))
    (note,) = notes(check_robot(drawn), CheckCode.HOME_AT_RANGE_END)
    assert "<key" not in note
    assert f"{equation} contradicts the ranges 0 to 1 of b and 0 to 1 of a; in the MJCF, widen" in note
    assert note.count("contradicts") == 1
    with pytest.raises(BenchError, match=re.escape(note)):
        room_of(read_geometry(drawn), ExperimentTable())


def test_a_home_outside_a_range_says_which_coupling_keeps_it_there(tmp_path):
    drawn = coupled(tmp_path, {"b": "0.5 1"}, proportional("b", "a", 0.1) + proportional("c", "b"))
    (failure,) = failures(check_robot(drawn))
    assert "joint 'b' is at 0 rad at home, outside its range" in failure
    assert "0.1 x^1 with x = 1 a contradicts the ranges 0.5 to 1 of b and -1 to 1 of a" in failure


def test_a_joint_without_room_in_any_pose_is_named(tmp_path):
    """Each coupling admits positions inside the ranges, but not both together."""
    drawn = coupled(tmp_path, {"a": "0 1", "c": "-1 0"}, proportional("b", "a") + proportional("c", "b"))
    (note,) = notes(check_robot(drawn), CheckCode.HOME_AT_RANGE_END)
    assert re.search(
        "no pose was reached with all joints inside their ranges: widen that of '[ac]' in the MJCF", note
    )


def test_tendons_that_couple_alike_are_refused_in_one_sentence(tmp_path):
    tendons = TENDONS.format(ab='range="-1 1" stiffness="3"', bc='range="-1 1" stiffness="3"')
    coupled = robot(tmp_path / "robot", CHAIN, "", ["a", "b", "c"], tendons)
    (failure,) = failures(check_robot(coupled))
    assert failure == (
        "tendons 'ab', 'bc' have stiffness, range: they couple joints, unknown to the model; remove them or the "
        "tendons from the MJCF"
    )


# --- pins, tools, shapes ------------------------------------------------------------------------------------


def four_bars(passive):
    return f"""<body name="crank"><joint name="crank" axis="0 1 0" range="-1 1"/>{INERTIAL}
        <body name="rod" pos="0 0 0.1"><joint name="pin" axis="0 1 0" {passive}/>{INERTIAL}
          <site name="tip" pos="0.2 0 0.02"/></body></body>
      <body name="rocker" pos="0.2 0 0"><joint name="rocker" axis="0 1 0" range="-3.2 3.14"/>{INERTIAL}
        <site name="end" pos="0 0 0.12"/></body>"""


def test_a_pin_with_a_range_of_a_whole_turn_has_no_end_stop(tmp_path):
    """Exporters write 0 to 2 pi for a pin: home would be at its end, and no motion could start there."""
    pin = '<connect site1="tip" site2="end"/>'
    turning = robot(tmp_path / "turning", four_bars('range="0 6.283185"'), pin, ["crank"])
    report = check_robot(turning)
    assert failures(report) == []
    assert notes(report, CheckCode.HOME_AT_RANGE_END) == []
    (note,) = notes(report, CheckCode.RANGES_OF_A_TURN)
    assert "pin, rocker" in note
    assert not turning.mjcf_model().joint("pin").limited  # of the simulated machine, too
    short = robot(tmp_path / "short", four_bars('range="0 3"'), pin, ["crank"])
    assert notes(check_robot(short), CheckCode.HOME_AT_RANGE_END)
    driven = robot(tmp_path / "driven", four_bars(""), pin, ["rocker"])
    assert driven.mjcf_model().joint("rocker").limited


def parallelogram(crank='range="0 0.9"', rocker='range="0 0.9"', coupler=""):
    """Of drawn lengths that agree to 4 µm."""
    return f"""<body name="crank"><joint name="crank" axis="0 1 0" {crank}/>{INERTIAL}
        <body name="coupler" pos="0 0 0.1"><joint name="coupler" axis="0 1 0" {coupler}/>{INERTIAL}
          <site name="tip" pos="0.2 0 0"/></body></body>
      <body name="rocker" pos="0.200004 0 0"><joint name="rocker" axis="0 1 0" {rocker}/>{INERTIAL}
        <site name="end" pos="0 0 0.100004"/></body>"""


@pytest.mark.parametrize("rounding", [0.0, 1e-16, 1e-3])
def test_a_proposed_home_leaves_room_for_planned_motions(rounding, tmp_path):
    """A home at the end of the ranges, or inside by less than planned motions keep free."""
    pin = '<connect site1="tip" site2="end"/>'
    rest = '<tendon><fixed name="drive"><joint joint="crank" coef="0.5"/></fixed></tendon><keyframe>{}</keyframe>'
    body = parallelogram().replace("0.200004", "0.2").replace("0.100004", "0.1")
    drawn_key = f'<key name="home" qpos="{rounding} {-rounding} {rounding}"/>'
    drawn = robot(tmp_path / "drawn", body, pin, ["drive"], rest.format(drawn_key))
    (note,) = notes(check_robot(drawn), CheckCode.HOME_AT_RANGE_END)
    (key,) = re.findall("<key .*/>", note)
    proposed = robot(tmp_path / "proposed", body, pin, ["drive"], rest.format(key))
    report = check_robot(proposed)
    assert notes(report, CheckCode.HOME_AT_RANGE_END) == []
    homes = [joint.home / joint.upper for joint in report.joints if joint.upper]
    assert len(homes) == 2
    assert all(LIMITS.margin < home < 1.0 - LIMITS.margin for home in homes)
    assert room_of(read_geometry(proposed), ExperimentTable())


def test_a_home_without_room_is_refused_with_the_pose_that_the_check_proposes(tmp_path):
    pin = '<connect site1="tip" site2="end"/>'
    body = parallelogram('range="-0.9 0.9"').replace("0.200004", "0.2").replace("0.100004", "0.1")
    key = '<keyframe><key name="home" qpos="1e-16 0 1e-16"/></keyframe>'
    drawn = robot(tmp_path / "drawn", body, pin, ["crank"], key)
    (note,) = notes(check_robot(drawn), CheckCode.HOME_AT_RANGE_END)
    assert "this pose closes further inside: <key " in note
    with pytest.raises(BenchError, match=re.escape(note)):
        room_of(read_geometry(drawn), ExperimentTable())


def test_an_end_stop_is_not_passed_by_the_rounding_of_a_drawing(tmp_path):
    """Both ends of a parallelogram have one range, and reach its end together."""
    pin = '<connect site1="tip" site2="end"/><joint joint1="other" joint2="crank" polycoef="0 1 0 0 0"/>'
    other = f'<body name="other"><joint name="other" axis="0 1 0" range="{{}} 0.9"/>{INERTIAL}</body>'
    within = parallelogram('range="0.1 0.9"', coupler='range="-0.9 0"') + other.format(0)
    key = '<keyframe><key name="home" qpos="0.3 -0.3 0.3 0.3"/></keyframe>'
    report = check_robot(robot(tmp_path / "within", within, pin, ["crank"], key))
    assert failures(report) == []
    assert notes(report, CheckCode.PASSIVE_RANGE_LEFT) == []
    beyond = within.replace("0 0.9", "0 0.8").replace("-0.9 0", "-0.8 0")
    (note,) = notes(
        check_robot(robot(tmp_path / "beyond", beyond, pin, ["crank"], key)), CheckCode.PASSIVE_RANGE_LEFT
    )
    assert "3 joints leave theirs" in note
    for joint in ("coupler", "rocker", "other"):
        assert f"'{joint}' (" in note


def test_a_tool_on_the_base_is_answered_with_the_sites_that_move(tmp_path):
    palm = f'<site name="palm"/>{CHAIN}'
    (failure,) = failures(
        check_robot(robot(tmp_path / "palm", palm, HELD, ["a"], TENDONS.format(ab="", bc=""), "palm"))
    )
    assert failure.endswith(
        "the tool site 'palm' does not move, since no joint carries it; sites that move: 'tip'"
    )


def test_bodies_of_the_base_need_no_mass(tmp_path):
    """Two shapes on a pad, two on the base: the pad is named, once."""
    shapes = '<geom type="mesh" mesh="shape"/><geom type="mesh" mesh="other"/><geom size="0.01"/>'
    path = tmp_path / "robot.xml"
    path.write_text(
        '<mujoco><asset><mesh name="shape" file="a.stl"/><mesh name="other" file="b.stl"/></asset><worldbody>'
        f'<body name="base">{shapes}<body name="arm"><joint axis="0 1 0"/>{INERTIAL}'
        f'<body name="pad">{shapes}</body></body></body></worldbody></mujoco>'
    )
    assert unreadable(path).bodies == ("pad",)


def test_attributes_of_older_files_are_read_without_lines_of_source(tmp_path, monkeypatch):
    """MuJoCo says in one line that `settotalmass` will be removed; Python's warning would add a line of code."""
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log
    path = tmp_path / "robot.xml"
    path.write_text(
        f'<mujoco><compiler angle="radian" settotalmass="1"/><worldbody>{CHAIN}</worldbody></mujoco>'
    )
    motors = [word for joint in "abc" for word in ("--motor", f"{joint}=1")]
    assert main(["robot", "new", str(path), *motors, "--tool", "tip"]) == 0
    assert main(["robot", "check", str(tmp_path)]) == 0
